// Length unit of files that carry none (STL, PLY, OBJ, point files).
#pragma once

#include <string>

namespace trueblade {

enum class LengthUnit { millimetre, centimetre, metre, inch, micrometre };
double millimetres_per(LengthUnit unit);
// "mm", "cm", "m", "in", "um"; throws InputError naming the valid units.
LengthUnit parse_length_unit(const std::string& text);

}  // namespace trueblade
