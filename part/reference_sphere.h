// A reference sphere for the calibration of a machine, as an exact CAD surface. Part frame (PCS), mm: the
// origin is the centre.
#pragma once

#include "part/part.h"

namespace trueblade {

struct ReferenceSphereParameters {
  double diameter_mm = 25.0;

  // Throws InputError naming the field, its value and the constraint.
  void validate() const;
};

Part make_reference_sphere(const ReferenceSphereParameters& parameters, const FacetingOptions& faceting);

}  // namespace trueblade
