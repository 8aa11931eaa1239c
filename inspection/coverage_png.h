// The picture of a plan's coverage: the part as the probe sees it from each view, with sample points in the
// colour of what becomes of them.
#pragma once

#include <filesystem>
#include <span>

#include "geometry/ray_caster.h"
#include "hardware/coverage.h"
#include "inspection/viewpoint.h"
#include "part/part.h"

namespace trueblade {

// One panel a view, up to four in a row; `viewpoints` are those of the views of `coverage`, in order. Colours
// as in coverage_svg. `caster` is over the model of `part`. Throws InputError when the file cannot be
// written.
void render_coverage_png(const std::filesystem::path& file, const Part& part, const RayCaster& caster,
                         const Coverage& coverage, std::span<const Viewpoint> viewpoints);

}  // namespace trueblade
