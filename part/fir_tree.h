// Outline of a fir-tree root across the machine's axis: (y, z) in mm, symmetric about y = 0.
#pragma once

#include <string>
#include <vector>

#include "geometry/vector.h"
#include "part/turbine_blade_parameters.h"

namespace trueblade {

// A straight line, or a circular arc through `middle`.
struct OutlinePiece {
  std::string name;
  Vec2 first, middle, last;
  bool is_arc;
};

// From the platform's underside on the suction side (+y) around the bottom to the underside on the pressure
// side: neck, teeth with a bearing flank above and a free flank below, every corner rounded and the neck
// blended into the underside. Throws InputError when the teeth do not fit the root or the radius does not fit
// the teeth.
std::vector<OutlinePiece> fir_tree_outline(const TurbineBladeParameters& parameters);

}  // namespace trueblade
