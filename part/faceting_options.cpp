#include "part/faceting_options.h"

#include <string>

#include "geometry/error.h"

namespace trueblade {

void FacetingOptions::validate() const {
  if (!(chord_tolerance_mm > 0.0))
    throw InputError("chord_tolerance_mm is " + std::to_string(chord_tolerance_mm) + ", must be above 0");
  if (!(angular_tolerance_rad > 0.0 && angular_tolerance_rad <= 1.6))
    throw InputError("angular_tolerance_rad is " + std::to_string(angular_tolerance_rad) +
                     ", must be above 0 and at most 1.6");
}

}  // namespace trueblade
