// The demonstration sheet part as a CAD shape. For the sources of part/ that include OpenCASCADE.
#pragma once

#include "part/cad_shape.h"
#include "part/formed_part_parameters.h"

namespace trueblade {

// A valid closed solid whose faces look outward. Throws InputError as write_formed_part does.
CadShape build_formed_part(const FormedPartParameters& parameters);

}  // namespace trueblade
