// The airfoil of the demonstration blade, its tip, and the fillet to the platform. For the sources of part/
// that include OpenCASCADE.
#pragma once

#include <TopoDS_Wire.hxx>

#include "geometry/vector.h"
#include "part/cad_solid.h"
#include "part/turbine_blade_parameters.h"

namespace trueblade {

struct BladeAirfoil {
  std::vector<NamedFace> faces;  // airfoil patches, fillet patches, tip
  TopoDS_Wire footprint;         // the fillet's border on the platform (z = 0), clockwise seen from +z
  Vec2 footprint_lower, footprint_upper;  // its bounding box
};

// Throws InputError when the section file is bad or an edge radius does not fit a section.
BladeAirfoil blade_airfoil_faces(const TurbineBladeParameters& parameters);

}  // namespace trueblade
