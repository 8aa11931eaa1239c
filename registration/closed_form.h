// Weighted absolute orientation in closed form (P9): the rigid transform that minimises
//   sum_i w_i || nominal_i - part_from_scan * measured_i ||^2.
//
// Any frames, mm. The rotation is found from the cross-covariance about the weighted centroids,
//   S_ab = sum_i w_i (measured_i - mean)_a (nominal_i - mean)_b
// (Horn 1987; the paper's print below Eq. 4 is corrected in docs/paper.md), so that the answer does not
// depend on the origin. Sums run in fixed blocks: the same bits on any number of threads.
#pragma once

#include <span>

#include "geometry/rigid_transform.h"

namespace trueblade {

// Preconditions: three spans of one length. Throws InputError when a weight is negative or not finite, all
// weights are zero, or fewer than three non-collinear measured points have weight.

// The rotation is the eigenvector of the largest eigenvalue of Horn's symmetric 4 x 4 matrix (Horn 1987, the
// paper's Eq. 3 and 4).
RigidTransform absolute_orientation_by_quaternion(std::span<const Vec3> measured_mm,
                                                  std::span<const Vec3> nominal_mm,
                                                  std::span<const double> weights);

// The rotation is V diag(1, 1, det(V U^T)) U^T of S = U D V^T (Arun et al. 1987, with Umeyama's 1991
// correction that keeps it proper for reflected and planar data).
RigidTransform absolute_orientation_by_svd(std::span<const Vec3> measured_mm,
                                           std::span<const Vec3> nominal_mm, std::span<const double> weights);

}  // namespace trueblade
