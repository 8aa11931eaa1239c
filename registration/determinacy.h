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

// What the surface tells about the pose, per point: the mean of J J' over the points with weight, with the
// normals of the smooth surface behind the facets (facets alone would stop a cylinder from turning). It is
// computed from about 250 points, every n-th.
struct SurfaceInformation {
  Mat6 per_point = Mat6::Zero();  // scaled tangent
  // Below this, information may be an artefact of the facets: the interpolated normals err to second order in
  // the angle between facet normal and smooth normal, so their spurious information is the square of that
  // angle's mean square. 1e-9 (a normal off by 3e-5) is the floor for exact surfaces and rounding.
  double least = 1e-9;
};
SurfaceInformation surface_information(const FacetModel& model, const Correspondences& correspondences,
                                       std::span<const double> weights);

// Splits the free directions by their information; at least `frozen` of them are called undetermined.
Determinacy split_directions(const SurfaceInformation& information, const FreeDirections& free,
                             Eigen::Index frozen);

// How many of the determined directions the scan does not determine in practice: their standard deviation
// exceeds a hundredth of the scan's radius. There a step leaves the range in which the tangent planes
// describe the part, and neither pose nor covariance mean anything along them.
Eigen::Index weakly_determined(const Mat6& covariance_scaled, const FreeDirections& determined,
                               double radius_mm);

std::vector<UndeterminedDirection> describe_undetermined(const FreeDirections& undetermined,
                                                         const StepFrame& frame);

}  // namespace trueblade
