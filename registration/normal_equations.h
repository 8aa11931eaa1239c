// The normal equations of the linearised distances, and the Gauss-Newton step they give.
#pragma once

#include <span>

#include "registration/correspondences.h"

namespace trueblade {

// Sums over the points with weight, in the scaled step u of the correspondences' frame:
//   objective(u) = sum_i w_i (d_i + J_i . u)^2.
struct NormalEquations {
  Mat6 hessian = Mat6::Zero();    // sum w J J'
  Vec6 gradient = Vec6::Zero();   // sum w d J
  double weighted_squares = 0.0;  // sum w d^2, mm^2
  double weight = 0.0;            // sum w
  std::size_t count = 0;          // points with weight

  NormalEquations& operator+=(const NormalEquations& other);
  double weighted_rms_mm() const;
};

// The same bits on any number of threads.
NormalEquations normal_equations(const Correspondences& correspondences, std::span<const double> weights);

// Directions in which the pose may move: orthonormal columns in the scaled tangent.
using FreeDirections = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

// The step that minimises the objective within the free directions, solved in the reduced system (solving
// for all six and zeroing the others afterwards would be wrong). Directions whose information is rounding
// (1e-12 of the mean weight, a normal's component of 1e-6) get no step.
Vec6 solve_step(const NormalEquations& equations, const FreeDirections& free);

}  // namespace trueblade
