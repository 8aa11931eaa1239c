// The picture of a registered scan: the part in light grey, the measured points as discs in the colours of
// their deviations, a colour bar with histogram and tolerance marks, and the facts of the view.
#pragma once

#include <filesystem>
#include <optional>

#include "geometry/ray_caster.h"
#include "inspection/deviations.h"
#include "inspection/result.h"
#include "inspection/tolerance.h"
#include "inspection/viewpoint.h"
#include "part/part.h"

namespace trueblade {

struct PictureOptions {
  int width_px = 1600;
  int height_px = 1200;
  std::optional<Tolerance> tolerance;  // marked on the colour bar
  void validate() const;               // throws InputError: 800 to 16384 pixels wide, 600 to 16384 high
};

// Draws and writes one picture. `caster` is over the model of `part`; `deviations` and `view` belong
// together. Throws InputError for options out of range or a file that cannot be written.
void render_deviation_png(const std::filesystem::path& file, const Part& part, const RayCaster& caster,
                          const Deviations& deviations, const ViewResult& view, const RunFacts& run,
                          const Viewpoint& viewpoint, const PictureOptions& options);

}  // namespace trueblade
