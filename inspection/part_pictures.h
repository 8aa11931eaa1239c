// Pictures of the part with the points of all views, always from the same directions: runs can be laid side
// by side, which pictures along each view's beam cannot.
#pragma once

#include <filesystem>

#include "geometry/ray_caster.h"
#include "inspection/deviations.h"
#include "inspection/result.h"
#include "part/part.h"

namespace trueblade {

// Writes from_plus_x.png, from_minus_x.png ... from_minus_z.png and oblique.png (see fixed_viewpoints) into
// the folder, 1200 x 900 pixels each. `title.statistics` are those of the deviations, `title.view` says whose
// they are. Throws InputError when a file cannot be written.
void render_part_pictures(const std::filesystem::path& folder, const Part& part, const RayCaster& caster,
                          const Deviations& deviations, const ViewResult& title, const RunFacts& run);

}  // namespace trueblade
