// Closed solids with named faces: from loose faces, and from one solid to the next. For the sources of part/
// that include OpenCASCADE.
#pragma once

#include <BRepBuilderAPI_MakeShape.hxx>
#include <string>
#include <vector>

#include "part/cad_shape.h"

namespace trueblade {

struct NamedFace {
  std::string name;
  TopoDS_Face face;
};

// The solid that the faces bound, each face looking outward, in the order given. Precondition: the faces meet
// edge to edge within 1e-6 mm and leave no gap; throws std::logic_error when they do not. Throws InputError
// when faces cross each other.
CadShape sew_solid(const std::vector<NamedFace>& faces);

// The solid that `operation` made of `solid`: old faces keep order and name, new ones follow as
// <new_name>_1, ... Throws InputError when the operation failed or its result is no valid solid.
CadShape successor(const CadShape& solid, BRepBuilderAPI_MakeShape& operation, const std::string& new_name);

}  // namespace trueblade
