// Coverage for people: a table, and a picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "hardware/coverage.h"

namespace trueblade {

// In all pictures of coverage: red, green, blue.
std::array<std::uint8_t, 3> access_colour(PointAccess access);

// "2 views see 99.8 % of the area".
std::string coverage_words(const Coverage& coverage);

// One line a surface: area, share seen from each view, share seen in all, and the reasons for the rest. The
// least seen surfaces come first.
std::string coverage_table(const Coverage& coverage, const Part& part);

// The same as a picture (SVG): one row a surface, one cell a view (darker: more of the surface is seen), and
// a bar of what is seen and what stands in the way of the rest.
std::string coverage_svg(const Coverage& coverage, const Part& part);

}  // namespace trueblade
