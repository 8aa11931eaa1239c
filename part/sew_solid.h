// From loose faces with common edges to one closed solid. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <string>
#include <vector>

#include "part/cad_shape.h"

namespace trueblade {

struct NamedFace {
  std::string name;
  TopoDS_Face face;
};

// The solid that the faces bound, each face looking outward, in the order given. Precondition: the faces meet
// edge to edge within 1e-6 mm and leave no gap; throws std::logic_error when they do not.
CadShape sew_solid(const std::vector<NamedFace>& faces);

}  // namespace trueblade
