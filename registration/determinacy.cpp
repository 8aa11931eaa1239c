#include "registration/determinacy.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "registration/smooth_normal.h"

namespace trueblade {
namespace {

// A rotation that moves the scan's edge by less than this fraction of the whole motion is called none: words
// are given to two digits.
constexpr double kNegligible = 1e-3;

// The same space with a basis in which as many vectors as possible are pure translations: rotating the basis
// by the right singular vectors of its rotation rows gathers the rotations in as few vectors as their rank.
FreeDirections translations_first(const FreeDirections& directions) {
  if (directions.cols() < 2) return directions;
  const Eigen::MatrixXd rotation_rows = directions.topRows<3>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rotation_rows, Eigen::ComputeFullV);
  return FreeDirections(directions * svd.matrixV()).rowwise().reverse();
}

// Without -0.000 and with the first large component positive: a direction has no sign.
Vec3 tidy(Vec3 axis) {
  axis.normalize();
  for (int k = 0; k < 3; ++k)
    if (std::abs(axis[k]) > 0.1) {
      if (axis[k] < 0.0) axis = -axis;
      break;
    }
  return axis;
}

std::string words_for(const Vec3& v) {
  const auto rounded = [](double x) { return std::abs(x) < 5e-4 ? 0.0 : x; };
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", rounded(v.x()), rounded(v.y()), rounded(v.z()));
}

std::string words_for(const Vec6& scaled, const StepFrame& frame) {
  const Vec6 step = frame.unscaled(scaled);
  const Vec3 turn = step.head<3>(), shift = step.tail<3>();
  if (scaled.head<3>().norm() < kNegligible) return "translation along " + words_for(tidy(shift));
  const Vec3 through = frame.pivot_part_mm + turn.cross(shift) / turn.squaredNorm();
  const double pitch_mm = turn.dot(shift) / turn.squaredNorm();  // per rad
  const std::string axis =
      fmt::format("an axis through {} mm along {}", words_for(through), words_for(tidy(turn)));
  if (std::abs(pitch_mm) < kNegligible * frame.radius_mm) return "rotation about " + axis;
  return fmt::format("screw motion of {:.3g} mm per rad about {}", pitch_mm, axis);
}

}  // namespace

SurfaceInformation surface_information(const FacetModel& model, const Correspondences& correspondences,
                                       std::span<const double> weights) {
  constexpr std::size_t kPoints = 250;
  const StepFrame& frame = correspondences.frame;
  const std::size_t stride = std::max<std::size_t>(1, correspondences.size() / kPoints);
  SurfaceInformation result;
  double count = 0.0, tilt_squares = 0.0;
  for (std::size_t i = stride / 2; i < correspondences.size(); i += stride) {
    if (weights[i] == 0.0) continue;
    Vec6 j = correspondences.jacobian.col(static_cast<Eigen::Index>(i));
    if (!correspondences.is_exact[i]) {
      const ClosestPoint& closest = correspondences.closest[i];
      const Vec3 normal = smooth_normal(model, closest.facet, closest.point_mm);
      tilt_squares += (normal - model.facet_normal(closest.facet)).squaredNorm();
      j << (closest.point_mm - frame.pivot_part_mm).cross(normal) / frame.radius_mm, normal;
    }
    result.per_point += j * j.transpose();
    count += 1.0;
  }
  if (count == 0.0) return result;
  result.per_point /= count;
  result.least = std::max(result.least, (tilt_squares / count) * (tilt_squares / count));
  return result;
}

Determinacy split_directions(const SurfaceInformation& information, const FreeDirections& free,
                             Eigen::Index frozen) {
  Determinacy result;
  if (free.cols() == 0) return result;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(free.transpose() * information.per_point * free));
  Eigen::Index undetermined = std::min(frozen, free.cols());  // eigenvalues ascend
  while (undetermined < free.cols() && !(eigen.eigenvalues()[undetermined] > information.least))
    ++undetermined;
  const Eigen::MatrixXd directions = free * eigen.eigenvectors();
  result.undetermined = translations_first(directions.leftCols(undetermined));
  result.determined = directions.rightCols(free.cols() - undetermined);
  return result;
}

Eigen::Index weakly_determined(const Mat6& covariance_scaled, const FreeDirections& determined,
                               double radius_mm) {
  if (determined.cols() == 0) return 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(determined.transpose() * covariance_scaled * determined), Eigen::EigenvaluesOnly);
  const double limit = 0.01 * radius_mm;
  return (eigen.eigenvalues().array() > limit * limit).count();
}

std::vector<UndeterminedDirection> describe_undetermined(const FreeDirections& undetermined,
                                                         const StepFrame& frame) {
  std::vector<UndeterminedDirection> result;
  for (Eigen::Index k = 0; k < undetermined.cols(); ++k) {
    const Vec6 direction = undetermined.col(k);
    result.push_back({direction, words_for(direction, frame)});
  }
  return result;
}

}  // namespace trueblade
