// Platform and fir-tree root of the demonstration blade. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <TopoDS_Wire.hxx>

#include "part/cad_solid.h"
#include "part/turbine_blade_parameters.h"

namespace trueblade {

// All faces below z = 0 and the platform's top, which leaves out what `footprint` (in z = 0, clockwise seen
// from +z) encloses.
std::vector<NamedFace> blade_root_faces(const TurbineBladeParameters& parameters,
                                        const TopoDS_Wire& footprint);

}  // namespace trueblade
