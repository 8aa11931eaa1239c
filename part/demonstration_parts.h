// Parametric demonstration parts, built with OpenCASCADE as real B-spline geometry and written as STEP.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// A compressor section: outline in unit chord, from the trailing edge over the suction side to the leading
// edge and back (Selig order).
struct AirfoilSection {
  std::string name;
  std::vector<Vec2> outline;
};

// Reads a Selig-format .dat file. Throws InputError naming file and line.
AirfoilSection read_airfoil(const std::filesystem::path& file);

// NACA 65-series-like section (thickness distribution and camber line of the series), for blades built
// without a file.
AirfoilSection compressor_section(double thickness_to_chord, double camber_lift_coefficient);

struct TurbineBladeParameters;
struct FormedPartParameters;

}  // namespace trueblade
