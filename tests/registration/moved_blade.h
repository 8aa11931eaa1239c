// The demonstration blade as CAD that stands elsewhere in its frame. Plain data, so that tests which use the
// part need not include OpenCASCADE.
#pragma once

#include "part/part.h"

namespace trueblade {

// Every point of the curves and surfaces themselves is moved: no placement is left to take the way back.
Part moved_turbine_blade(const Vec3& translation_mm, const FacetingOptions& faceting);

}  // namespace trueblade
