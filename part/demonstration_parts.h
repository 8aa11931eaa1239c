// The parametric demonstration parts, built with OpenCASCADE as B-spline geometry: see
// docs/demonstration_parts.md.
#pragma once

#include "part/formed_part.h"
#include "part/turbine_blade.h"
