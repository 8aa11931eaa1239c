#include "registration/cross_check.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "part/exact_closest_point.h"
#include "registration/closed_form.h"
#include "registration/rotation_jacobian.h"

namespace trueblade {
namespace {

constexpr std::size_t kBlock = 1024;

ceres::Solver::Options tight_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  // The cost is flat to its rounding within 1e-8 of the minimum's width; only the step tells the rest.
  options.function_tolerance = 0.0;
  options.gradient_tolerance = 1e-30;
  options.parameter_tolerance = 1e-15;
  options.logging_type = ceres::SILENT;
  return options;
}

struct PairResidual {
  Vec3 measured, nominal;
  double root_weight;
  template <class T>
  bool operator()(const T* rotation, const T* translation, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> q(rotation);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t(translation);
    Eigen::Map<Eigen::Matrix<T, 3, 1>> r(residual);
    r = T(root_weight) * (nominal.cast<T>() - q * measured.cast<T>() - t);
    return true;
  }
};

struct MotionBetweenCentroids {
  Eigen::Quaterniond rotation;
  Vec3 translation = Vec3::Zero();
};

Vec6 gradient_of(ceres::Problem& problem, MotionBetweenCentroids& at) {
  ceres::Problem::EvaluateOptions order;
  order.parameter_blocks = {at.rotation.coeffs().data(), at.translation.data()};
  std::vector<double> gradient;  // in the tangent
  problem.Evaluate(order, nullptr, nullptr, &gradient, nullptr);
  return Eigen::Map<const Vec6>(gradient.data());
}

// A solver that compares costs stops where they differ by rounding, up to 1e-4 rad from the minimum of a
// nearly degenerate problem. The gradient tells the rest: a few Newton steps, the Hessian by differences of
// Ceres's gradient.
void polish(ceres::Problem& problem, MotionBetweenCentroids& motion) {
  constexpr int kSteps = 4;  // each squares the error
  constexpr double kDifference = 1e-6;
  const ceres::Manifold& manifold = *problem.GetManifold(motion.rotation.coeffs().data());
  for (int k = 0; k < kSteps; ++k) {
    const MotionBetweenCentroids here = motion;
    const auto move = [&](const Vec6& step) {
      manifold.Plus(here.rotation.coeffs().data(), step.data(), motion.rotation.coeffs().data());
      motion.translation = here.translation + step.tail<3>();
    };
    Mat6 hessian;
    for (int axis = 0; axis < 6; ++axis) {
      move(kDifference * Vec6::Unit(axis));
      hessian.col(axis) = gradient_of(problem, motion);
      move(-kDifference * Vec6::Unit(axis));
      hessian.col(axis) -= gradient_of(problem, motion);
    }
    hessian /= 2.0 * kDifference;
    move(Vec6::Zero());
    move(-hessian.ldlt().solve(gradient_of(problem, motion)));
  }
}

Vec3 weighted_mean(std::span<const Vec3> points, std::span<const double> weights) {
  Vec3 sum = Vec3::Zero();
  double weight = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += weights[i] * points[i];
    weight += weights[i];
  }
  return sum / weight;
}

// sqrt(w) times the distance of every point to the surface, as a function of a step along the determined
// directions from the claimed pose.
class SurfaceDistances : public ceres::CostFunction {
 public:
  explicit SurfaceDistances(const RegistrationClaim& claim) : claim_(claim) {
    for (std::size_t i = 0; i < claim.weights.size(); ++i)
      if (claim.weights[i] > 0.0) used_.push_back(i);
    set_num_residuals(static_cast<int>(used_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(claim.determined.cols()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index m = claim_.determined.cols();
    const Eigen::VectorXd along = Eigen::Map<const Eigen::VectorXd>(parameters[0], m);
    const Vec6 step = claim_.frame.unscaled(claim_.determined * along);
    const RigidTransform pose = moved_about(claim_.part_from_mcs, step, claim_.frame.pivot_part_mm);
    const Mat3 turn = rotation_jacobian(step.head<3>());
    const Vec3 centre = claim_.frame.pivot_part_mm + step.tail<3>();
    parallel_for_blocks(used_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Vec3 x = pose * claim_.position_mcs_mm[used_[k]];
        Vec3 normal;
        const double root_weight = std::sqrt(claim_.weights[used_[k]]);
        residuals[k] = root_weight * signed_distance(x, normal);
        if (!jacobians || !jacobians[0]) continue;
        Vec6 j;
        j << turn.transpose() * (x - centre).cross(normal) / claim_.frame.radius_mm, normal;
        Eigen::Map<Eigen::VectorXd>(jacobians[0] + static_cast<Eigen::Index>(k) * m, m) =
            root_weight * (claim_.determined.transpose() * j);
      }
    });
    return true;
  }

 private:
  double signed_distance(const Vec3& x, Vec3& normal) const {
    const ClosestPoint closest = claim_.target.tree().query(x);
    Vec3 foot = closest.point_mm;
    normal = claim_.target.model().facet_normal(closest.facet);
    if (claim_.exact) {
      if (const auto exact = refine_to_exact(claim_.target.part(), closest, x)) {
        foot = exact->foot.point_mm;
        normal = exact->foot.normal;
      }
    }
    const double distance = (x - foot).norm();
    const double side = normal.dot(x - foot) < 0.0 ? -1.0 : 1.0;
    if (distance > 1e-6) normal = side * (x - foot) / distance;  // nearer, the direction is rounding
    return side * distance;
  }

  const RegistrationClaim& claim_;
  std::vector<std::size_t> used_;
};

// The same distances without their derivatives.
struct DistancesAlone {
  const SurfaceDistances& distances;
  bool operator()(double const* const* parameters, double* residuals) const {
    return distances.Evaluate(parameters, residuals, nullptr);
  }
};

// (sum w J J')^-1 within the determined directions, by Ceres at its own minimum. J by central differences of
// the distances: it owes nothing to the derivatives of the registration.
Eigen::MatrixXd ceres_covariance(const SurfaceDistances& distances, double* along, Eigen::Index size) {
  auto* cost = new ceres::DynamicNumericDiffCostFunction<DistancesAlone, ceres::CENTRAL>(
      new DistancesAlone{distances});
  cost->AddParameterBlock(static_cast<int>(size));
  cost->SetNumResiduals(distances.num_residuals());
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, along);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result(size, size);
  result.setConstant(std::numeric_limits<double>::quiet_NaN());
  const std::vector<std::pair<const double*, const double*>> block{{along, along}};
  if (covariance.Compute(block, &problem)) covariance.GetCovarianceBlock(along, along, result.data());
  return result;
}

// Largest difference of two covariances, relative to the standard deviations of row and column.
double relative_difference(const Eigen::MatrixXd& theirs, const Eigen::MatrixXd& ours) {
  const Eigen::VectorXd deviation = ours.diagonal().cwiseSqrt();
  return (theirs - ours).cwiseQuotient(deviation * deviation.transpose()).cwiseAbs().maxCoeff();
}

void check_closed_form(const RegistrationClaim& claim, CrossCheck& check) {
  const RigidTransform ours =
      absolute_orientation_by_quaternion(claim.position_mcs_mm, claim.closest_part_mm, claim.weights);
  const RigidTransform theirs = absolute_orientation_by_ceres(claim.position_mcs_mm, claim.closest_part_mm,
                                                              claim.weights, claim.part_from_mcs);
  check.closed_form_rotation_difference_rad = rotation_angle_between(ours, theirs);
  for (std::size_t i = 0; i < claim.weights.size(); ++i)
    if (claim.weights[i] > 0.0)
      check.closed_form_difference_mm =
          std::max(check.closed_form_difference_mm,
                   (ours * claim.position_mcs_mm[i] - theirs * claim.position_mcs_mm[i]).norm());
}

}  // namespace

RigidTransform absolute_orientation_by_ceres(std::span<const Vec3> measured_mm,
                                             std::span<const Vec3> nominal_mm,
                                             std::span<const double> weights, const RigidTransform& start) {
  const Vec3 measured_mean = weighted_mean(measured_mm, weights);
  const Vec3 nominal_mean = weighted_mean(nominal_mm, weights);
  MotionBetweenCentroids motion{start.rotation};
  ceres::Problem problem;
  for (std::size_t i = 0; i < measured_mm.size(); ++i) {
    if (weights[i] == 0.0) continue;
    auto* residual = new ceres::AutoDiffCostFunction<PairResidual, 3, 4, 3>(new PairResidual{
        measured_mm[i] - measured_mean, nominal_mm[i] - nominal_mean, std::sqrt(weights[i])});
    problem.AddResidualBlock(residual, nullptr, motion.rotation.coeffs().data(), motion.translation.data());
  }
  problem.SetManifold(motion.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
  ceres::Solver::Summary summary;
  ceres::Solve(tight_options(), &problem, &summary);
  polish(problem, motion);
  RigidTransform result;
  result.rotation = motion.rotation.normalized();
  result.translation_mm = nominal_mean + motion.translation - result.rotation * measured_mean;
  return result;
}

CrossCheck cross_check_registration(const RegistrationClaim& claim) {
  CrossCheck check{};
  const Eigen::Index m = claim.determined.cols();
  if (m == 0) {
    check.agrees = true;
    check.summary = "nothing to check: no direction is determined";
    return check;
  }
  Eigen::VectorXd along = Eigen::VectorXd::Zero(m);
  ceres::Problem problem;
  auto* distances = new SurfaceDistances(claim);
  problem.AddResidualBlock(distances, nullptr, along.data());  // which owns it
  ceres::Solver::Summary summary;
  ceres::Solve(tight_options(), &problem, &summary);

  const Vec6 step = claim.frame.unscaled(claim.determined * along);
  check.rotation_difference_rad = step.head<3>().norm();
  check.centroid_difference_mm = step.tail<3>().norm();
  const Eigen::MatrixXd covariance =
      claim.determined.transpose() * claim.covariance_scaled * claim.determined;
  const double uncertainties =
      std::sqrt(std::max(0.0, along.dot(covariance.ldlt().solve(along))) / static_cast<double>(m));
  const Eigen::MatrixXd theirs = ceres_covariance(*distances, along.data(), m);
  const Eigen::MatrixXd ours = (claim.determined.transpose() * claim.hessian * claim.determined)
                                   .ldlt()
                                   .solve(Eigen::MatrixXd::Identity(m, m));
  check.covariance_relative_difference = relative_difference(theirs, ours);
  if (claim.sigma_mm && *claim.sigma_mm > 0.0)
    check.covariance_relative_difference =
        std::max(check.covariance_relative_difference,
                 relative_difference(*claim.sigma_mm * *claim.sigma_mm * theirs, covariance));
  const bool same_pose = uncertainties < 0.1 || along.norm() < 1e-9;
  check_closed_form(claim, check);
  const bool same_closed_form =
      check.closed_form_rotation_difference_rad < 1e-10 && check.closed_form_difference_mm < 1e-9;
  check.agrees = same_pose && check.covariance_relative_difference < 0.02 && same_closed_form;
  check.summary = fmt::format(
      "{}: rotation differs by {:.3g} rad, centroid by {:.3g} mm ({:.3g} standard uncertainties), covariance "
      "by {:.2g} %; closed form by {:.2g} rad, {:.2g} mm",
      check.agrees ? "agrees" : "disagrees", check.rotation_difference_rad, check.centroid_difference_mm,
      uncertainties, 100.0 * check.covariance_relative_difference, check.closed_form_rotation_difference_rad,
      check.closed_form_difference_mm);
  return check;
}

}  // namespace trueblade
