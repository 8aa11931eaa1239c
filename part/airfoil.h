// Compressor sections in unit chord: read from a file, or the NACA 65 series.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// The outline of a section, chord along x from 0 to 1, from the trailing edge over the upper (suction) side
// to the leading edge and back along the lower (pressure) side: Selig's order.
struct AirfoilSection {
  std::string name;
  std::vector<Vec2> outline;
};

// Reads a Selig-format .dat file: a title line, then one point "x y" per line. Throws InputError naming file
// and line when it is not of this format, a number is not finite, the outline does not run 1 -> 0 -> 1 in x,
// or the upper side lies below the lower one.
AirfoilSection read_airfoil(const std::filesystem::path& file);

// NACA 65-series section of 10 % thickness on the a = 1.0 mean line with the given design lift coefficient:
// the thickness is laid off normal to the mean line (Abbott and von Doenhoff 1959, eq. 6.1, 6.4 and
// appendix I, 65-010). Precondition: 0 <= lift coefficient <= 2.
AirfoilSection naca_65_section(double design_lift_coefficient);

}  // namespace trueblade
