// Which directions of the pose the scan determines, from the spectrum of the scaled normal matrix, and words
// for those that it does not (a plane slides and spins, a cylinder slides and turns, a sphere turns; Gelfand
// and Guibas 2004 call such shapes slippable).
#pragma once

#include <vector>

#include "registration/normal_equations.h"
#include "registration/result.h"

namespace trueblade {

struct Determinacy {
  FreeDirections determined;    // orthonormal, scaled tangent
  FreeDirections undetermined;  // orthonormal, scaled tangent; pure translations first
};

// Splits the free directions by their information per unit weight: the mean square of the component of the
// surface normal along the motion of the points.
Determinacy split_directions(const Mat6& information_per_weight, const FreeDirections& free,
                             double least_information);

std::vector<UndeterminedDirection> describe_undetermined(const FreeDirections& undetermined,
                                                         const StepFrame& frame);

}  // namespace trueblade
