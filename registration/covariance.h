// Covariance of the registered pose (NoiseModel and docs/paper.md state the assumptions).
//
// With H = sum w J J' and the noise of a distance sigma^2 v_i, the estimate's covariance is
//   H^-1 (sum w^2 sigma^2 v J J') H^-1,
// times what rejection does to it. A cut at c = k sigma removes the tails of the good points: with
// P = 2 Phi(k) - 1 of them left and B = P - 2 k phi(k), the variance of the remaining residuals is
// sigma^2 B / P, and a pose fitted within a cut that moves with it has P / B times the covariance of a fit to
// as many untruncated points (the influence function x 1(|x| < c); Hampel et al. 1986). Redescending weights
// psi(x) / x enter by mean psi^2 / (mean psi')^2.
#pragma once

#include <span>

#include "registration/normal_equations.h"
#include "registration/rejection.h"

namespace trueblade {

// Standard deviation of the untruncated normal distribution whose part within +-cut_mm has the root mean
// square `truncated_rms_mm`. A root mean square above 0.5 cut is as good as uniform over the cut (0.577 cut)
// and tells nothing of sigma; then truncated_rms_mm itself is returned.
double untruncated_sigma_mm(double truncated_rms_mm, double cut_mm);

struct PoseCovariance {
  Mat6 scaled = Mat6::Zero();  // of the scaled step; zero along directions that are not determined
  double sigma_mm = 0.0;
  bool sigma_estimated = true;
};

// `base` are the weights before rejection, `weights` those after it, at the registered pose.
PoseCovariance pose_covariance(const Correspondences& correspondences, std::span<const double> base,
                               std::span<const double> weights, const RejectionScale& scale,
                               const FreeDirections& determined, const RegistrationOptions& options);

// The covariance of a tangent step (rotation, then translation of the pivot) about the pivot `from` expressed
// about the pivot `to`: the rotation is the same, the pivot's motion differs.
Mat6 covariance_about_pivot(const Mat6& covariance, const Vec3& from, const Vec3& to);

}  // namespace trueblade
