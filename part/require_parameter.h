// Checks of the parameters of the demonstration parts.
#pragma once

#include <fmt/core.h>

#include "geometry/error.h"

namespace trueblade {

// Throws InputError "<name> is <value>, must be <constraint>" unless `holds`; a comparison with NaN does not.
inline void require_parameter(bool holds, const char* name, double value, const std::string& constraint) {
  if (!holds) throw InputError(fmt::format("{} is {}, must be {}", name, value, constraint));
}

inline void require_within(const char* name, double value, double lowest, double highest) {
  require_parameter(value >= lowest && value <= highest, name, value,
                    fmt::format("between {} and {}", lowest, highest));
}

}  // namespace trueblade
