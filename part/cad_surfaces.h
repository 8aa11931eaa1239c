// The CAD faces as ExactSurfaces holds them. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <memory>
#include <string>
#include <vector>

#include "part/exact_surfaces.h"

namespace trueblade {

// Surface i is face i. The faces must carry a triangulation made with that chord tolerance: the border of a
// face is taken from its trimming curves at the parameters of the triangulation's nodes, and refined between
// them.
std::shared_ptr<const ExactSurfaces> make_exact_surfaces(const std::vector<TopoDS_Face>& faces,
                                                         double chord_tolerance_mm);

// "plane", "cylinder", "cone", "sphere", "torus", "b-spline", "bezier", "extrusion", "revolution", "offset",
// or "other".
std::string surface_kind(const TopoDS_Face& face);

}  // namespace trueblade
