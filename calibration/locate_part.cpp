#include "calibration/locate_part.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>

#include "geometry/error.h"
#include "registration/closed_form.h"

namespace trueblade {
namespace {

void check(std::span<const TouchedPoint> points, double sigma_mm) {
  if (!(sigma_mm > 0.0 && std::isfinite(sigma_mm)))
    throw InputError(fmt::format("sigma_mm is {}, must be above 0", sigma_mm));
  if (points.size() < 3)
    throw InputError(fmt::format("{} points were touched, must be at least 3", points.size()));
  std::set<std::string> names;
  for (const TouchedPoint& point : points) {
    if (point.name.empty()) throw InputError("a touched point has no name");
    if (!names.insert(point.name).second)
      throw InputError(fmt::format("point \"{}\" is there twice, names must differ", point.name));
    if (!point.part_mm.allFinite() || !point.mcs_mm.allFinite())
      throw InputError(fmt::format("point \"{}\" has coordinates that are not finite", point.name));
  }
}

// Quantile of chi square by the cube root that is nearly normal (Wilson and Hilferty 1931); within 2 % from
// three degrees of freedom up at this probability.
double chi_square_999(double freedoms) {
  constexpr double kNormal999 = 3.0902;
  const double spread = 2.0 / (9.0 * freedoms);
  return freedoms * std::pow(1.0 - spread + kNormal999 * std::sqrt(spread), 3);
}

void require_agreement(std::span<const TouchedPoint> points, const PartLocation& location, double sigma_mm) {
  double chi_square = 0.0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    chi_square += location.residual_mcs_mm[i].squaredNorm() / (sigma_mm * sigma_mm);
    if (location.residual_mcs_mm[i].norm() > location.residual_mcs_mm[worst].norm()) worst = i;
  }
  const double bound = chi_square_999(3.0 * static_cast<double>(points.size()) - 6.0);
  if (chi_square <= bound) return;
  throw InputError(fmt::format(
      "the points contradict each other: chi square {:.3g} of their residuals, must be at most {:.3g} "
      "with sigma_mm {}; \"{}\" is off by {:.3g} mm (are two points exchanged?)",
      chi_square, bound, sigma_mm, points[worst].name, location.residual_mcs_mm[worst].norm()));
}

}  // namespace

PartLocation locate_part(std::span<const TouchedPoint> points, double sigma_mm) {
  check(points, sigma_mm);
  std::vector<Vec3> part, mcs;
  Vec3 sum = Vec3::Zero();
  for (const TouchedPoint& point : points) {
    part.push_back(point.part_mm);
    mcs.push_back(point.mcs_mm);
    sum += point.mcs_mm;
  }
  const double count = static_cast<double>(points.size());
  PartLocation location{};
  location.pivot_mcs_mm = sum / count;

  // Rotation about the mean: a point at r moves by omega x r, so that its Hessian is sum (r^2 I - r r').
  // By the measured points, before the fit: points on a line leave it no unique answer.
  Mat3 hessian = Mat3::Zero();
  for (const Vec3& point : mcs) {
    const Vec3 r = point - location.pivot_mcs_mm;
    hessian += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
  }
  constexpr double kUnsureRad = 0.1;
  const double least = Eigen::SelfAdjointEigenSolver<Mat3>(hessian).eigenvalues()(0);
  if (!(sigma_mm <= kUnsureRad * std::sqrt(std::max(least, 0.0))))
    throw InputError(fmt::format(
        "the points lie so near one line, or one another, that the rotation is determined to {:.3g} rad "
        "only, must be within {}",
        sigma_mm / std::sqrt(std::max(least, 0.0)), kUnsureRad));

  const std::vector<double> weights(points.size(), 1.0);
  location.mcs_from_part = absolute_orientation_by_svd(part, mcs, weights);
  location.covariance.topLeftCorner<3, 3>() = sigma_mm * sigma_mm * hessian.inverse();
  location.covariance.bottomRightCorner<3, 3>() = sigma_mm * sigma_mm / count * Mat3::Identity();
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    location.residual_mcs_mm.push_back(mcs[i] - location.mcs_from_part * part[i]);
    squares += location.residual_mcs_mm.back().squaredNorm();
  }
  location.rms_mm = std::sqrt(squares / count);
  require_agreement(points, location, sigma_mm);
  return location;
}

}  // namespace trueblade
