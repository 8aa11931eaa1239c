// Length unit of files that carry none (STL, PLY, OBJ, point files).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace trueblade {

enum class LengthUnit { millimetre, centimetre, metre, inch, micrometre };
double millimetres_per(LengthUnit unit);
// "mm", "cm", "m", "in", "um"; throws InputError naming the valid units.
LengthUnit parse_length_unit(const std::string& text);

// The unit that a comment "unit mm" states.
std::optional<LengthUnit> unit_in_comment(std::string_view comment);

// The unit of a file from what the user gave and what the file states. Throws InputError naming the file when
// both are missing or differ.
LengthUnit settled_unit(const std::filesystem::path& file, std::optional<LengthUnit> given,
                        std::optional<LengthUnit> stated);

}  // namespace trueblade
