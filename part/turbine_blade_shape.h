// The demonstration blade as a CAD shape. For the sources of part/ that include OpenCASCADE.
#pragma once

#include "part/cad_shape.h"
#include "part/turbine_blade_parameters.h"

namespace trueblade {

// A valid closed solid whose faces look outward. Throws InputError as write_turbine_blade does.
CadShape build_turbine_blade(const TurbineBladeParameters& parameters);

}  // namespace trueblade
