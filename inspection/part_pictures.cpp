#include "inspection/part_pictures.h"

#include "inspection/render_png.h"

namespace trueblade {

void render_part_pictures(const std::filesystem::path& folder, const Part& part, const RayCaster& caster,
                          const Deviations& deviations, const ViewResult& title, const RunFacts& run) {
  PictureOptions options;
  options.width_px = 1200;
  options.height_px = 900;
  options.tolerance = run.tolerance;
  for (const Viewpoint& viewpoint : fixed_viewpoints())
    render_deviation_png(folder / (viewpoint.name + ".png"), part, caster, deviations, title, run, viewpoint,
                         options);
}

}  // namespace trueblade
