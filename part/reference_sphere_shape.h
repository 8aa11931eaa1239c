// The reference sphere as a CAD shape. For the sources of part/ that include OpenCASCADE.
#pragma once

#include "part/cad_shape.h"

namespace trueblade {

CadShape build_reference_sphere(double diameter_mm);

}  // namespace trueblade
