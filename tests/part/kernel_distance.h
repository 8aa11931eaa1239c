// Distances as the CAD kernel itself finds them. Plain data, so that tests which use the facet model need not
// include OpenCASCADE.
#pragma once

#include <filesystem>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// Of each point from the nearest face of the STEP file, mm. Slow: every face is searched for all its extrema.
std::vector<double> kernel_distances_mm(const std::filesystem::path& step_file,
                                        const std::vector<Vec3>& points_mm);

}  // namespace trueblade
