#include "registration/covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/robust_sigma.h"
#include "registration/normal_equations.h"

namespace trueblade {
namespace {

// Weights of the points in sum w^2 v J J', the matrix of the noise that they carry into the gradient.
std::vector<double> noise_weights(const Correspondences& c, std::span<const double> bread,
                                  std::span<const double> weights, NoiseModel model) {
  std::vector<double> noise(bread.begin(), bread.end());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    if (model == NoiseModel::equal) noise[i] *= bread[i];
    if (model == NoiseModel::from_residuals)
      noise[i] = bread[i] == 0.0 ? 0.0 : weights[i] * weights[i] * c.distance_mm[i] * c.distance_mm[i];
  }
  return noise;
}

// Sum of squared residuals in the noise model's unit weight.
double sum_of_squares(const Correspondences& c, std::span<const double> bread, NoiseModel model) {
  double sum = 0.0;
  for (std::size_t i = 0; i < bread.size(); ++i)
    if (bread[i] != 0.0)
      sum += (model == NoiseModel::inverse_to_weight ? bread[i] : 1.0) * c.distance_mm[i] * c.distance_mm[i];
  return sum;
}

// Means over the points with weight of a redescending influence function and of its derivative, residuals in
// units of sigma.
struct Influence {
  double mean_square = 0.0;
  double mean_slope = 0.0;
};

Influence redescending_influence(const Correspondences& c, std::span<const double> base, double sigma,
                                 const RejectionOptions& options) {
  const bool biweight = options.rule == RejectionRule::tukey;
  const double width = biweight ? options.tukey_constant : options.welsch_constant;
  Influence sum;
  double count = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (base[i] == 0.0) continue;
    count += 1.0;
    const double x = c.distance_mm[i] / sigma, u2 = (x / width) * (x / width);
    const double rest = biweight ? std::max(0.0, 1.0 - u2) : std::exp(-u2);
    const double psi = biweight ? x * rest * rest : x * rest;
    sum.mean_square += psi * psi;
    sum.mean_slope += biweight ? rest * (1.0 - 5.0 * u2) : (1.0 - 2.0 * u2) * rest;
  }
  return {sum.mean_square / count, sum.mean_slope / count};
}

Mat6 inverse_within(const Mat6& hessian, const FreeDirections& determined) {
  const Eigen::MatrixXd reduced = determined.transpose() * hessian * determined;
  const Eigen::MatrixXd inverse =
      reduced.ldlt().solve(Eigen::MatrixXd::Identity(reduced.rows(), reduced.cols()));
  return determined * inverse * determined.transpose();
}

}  // namespace

double untruncated_sigma_mm(double truncated_rms_mm, double cut_mm) {
  if (!std::isfinite(cut_mm)) return truncated_rms_mm;  // no cut
  if (!(truncated_rms_mm > 0.0) || !(truncated_rms_mm < 0.5 * cut_mm)) return truncated_rms_mm;
  // sigma sqrt(B / P) rises with sigma from 0 to cut / sqrt(3): bisection between the truncated RMS and twice
  // the cut, to the last bit of a double.
  double low = truncated_rms_mm, high = 2.0 * cut_mm;
  for (int k = 0; k < 60; ++k) {
    const double sigma = 0.5 * (low + high);
    const Truncation t = truncation_at(cut_mm / sigma);
    (sigma * std::sqrt(t.second / t.inside) < truncated_rms_mm ? low : high) = sigma;
  }
  return 0.5 * (low + high);
}

PoseCovariance pose_covariance(const Correspondences& correspondences, std::span<const double> base,
                               std::span<const double> weights, const RejectionScale& scale,
                               const FreeDirections& determined, const RegistrationOptions& options) {
  PoseCovariance result;
  if (determined.cols() == 0) return result;
  const bool redescending =
      options.rejection.rule == RejectionRule::tukey || options.rejection.rule == RejectionRule::welsch;
  const NoiseModel model = options.covariance.noise;
  const std::span<const double> bread = redescending ? base : weights;
  const NormalEquations equations = normal_equations(correspondences, bread);
  const double count = static_cast<double>(equations.count);
  const double freedom = count - static_cast<double>(determined.cols());
  if (!(freedom > 0.0)) return result;

  const double estimate =
      redescending ? scale.sigma_mm
                   : untruncated_sigma_mm(std::sqrt(sum_of_squares(correspondences, bread, model) / freedom),
                                          scale.cut_mm);
  result.sigma_estimated = !options.covariance.sigma_mm.has_value();
  result.sigma_mm = options.covariance.sigma_mm.value_or(estimate);

  // Variance factor of the influence function, for noise of unit variance, and of its slope alone.
  double variance = 1.0, slope = 1.0;
  if (redescending) {
    const Influence influence =
        redescending_influence(correspondences, base, scale.sigma_mm, options.rejection);
    slope = influence.mean_slope;
    variance = influence.mean_square / (slope * slope);
  } else if (estimate > 0.0) {
    const Truncation t = truncation_at(scale.cut_mm / estimate);
    slope = t.second / t.inside;
    variance = 1.0 / slope;
  }
  const Mat6 inverse = inverse_within(equations.hessian, determined);
  const Mat6 noise =
      normal_equations(correspondences, noise_weights(correspondences, bread, weights, model)).hessian;
  const Mat6 sandwich = inverse * noise * inverse;
  result.scaled = model == NoiseModel::from_residuals
                      ? Mat6(count / freedom / (slope * slope) * sandwich)
                      : Mat6(result.sigma_mm * result.sigma_mm * variance * sandwich);
  return result;
}

Mat6 covariance_about_pivot(const Mat6& covariance, const Vec3& from, const Vec3& to) {
  Mat6 change = Mat6::Identity();
  const Vec3 arm = to - from;  // translation' = translation + rotation x arm
  change.block<3, 3>(3, 0) << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  return change * covariance * change.transpose();
}

}  // namespace trueblade
