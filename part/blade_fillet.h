// The fillet between an airfoil strip and the platform. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <Geom_BSplineSurface.hxx>

namespace trueblade {

// A quarter circle as one cubic across, from the platform z = 0 (v = 0) to the airfoil at z = radius (v = 1),
// over the airfoil's own u. `airfoil` runs clockwise seen from +z in u, from 0 to 1 with `intervals` equal
// knot intervals, and has v = z.
//
// It leaves the platform within its plane and meets the airfoil along the airfoil's tangents. Strips that
// share an end of the section and the section's tangent there meet without a kink.
Handle(Geom_BSplineSurface)
    blade_fillet(const Handle(Geom_BSplineSurface) & airfoil, int intervals, double radius_mm);

}  // namespace trueblade
