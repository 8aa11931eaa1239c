// A twisted, tapered compressor blade with fillet, platform and fir-tree root, as a valid B-spline solid.
//
// Part frame (PCS), mm: the origin lies on the stacking axis (the sections' centroids) at the platform's top,
// z points to the tip, x along the machine's axis from leading to trailing edge, y to the suction side.
#pragma once

#include <filesystem>

#include "part/part.h"
#include "part/turbine_blade_parameters.h"

namespace trueblade {

// Writes the blade as STEP (AP214, mm). Throws InputError for parameters that make no blade (an edge radius
// that does not fit the section, a fillet that leaves the platform, teeth that do not fit the root), a bad
// section file, or a file that cannot be written.
void write_turbine_blade(const TurbineBladeParameters& parameters, const std::filesystem::path& step_file);

// The same blade as a nominal part.
Part make_turbine_blade(const TurbineBladeParameters& parameters, const FacetingOptions& faceting);

}  // namespace trueblade
