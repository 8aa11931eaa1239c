// Statistical efficiency of the registration: 1,000 scans with known noise of one view of an analytic blade,
// without and with 20 % gross outliers. Prints the spread of the pose over the Cramer-Rao bound
// sigma^2 (J'J)^-1 of the good points, the bias over that bound, and how often the 95 % covariance ellipsoid
// covers the truth: for the default, and for the other rejection rules in its place.
//
//   registration_efficiency [scans] [scans for the other rules] [points]
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cstdlib>

#include "registration/register_scan.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kSigma_mm = 0.003;          // the 25 mm lens
constexpr double kOutlier_mm = 1.0;          // gross outliers: uniform within +-1 mm of the surface
constexpr double kChiSquare95 = 12.5915872;  // 95 % quantile, six degrees of freedom

struct Scan {
  std::vector<Vec3> point, normal;
};

// Points exactly on the facets with their normals: the noise is added per trial.
Scan ideal_scan(const Part& part, std::size_t points) {
  Scan scan;
  const Vec3 view(0.3, 1.0, 0.4);
  scan.point = shapes::points_on(part, points, view, 0.0, 7);
  const ClosestPointTree tree(part.model);
  for (const Vec3& p : scan.point) scan.normal.push_back(part.model.facet_normal(tree.query(p).facet));
  return scan;
}

struct Outcome {
  Vec6 mean = Vec6::Zero();
  Mat6 spread = Mat6::Zero();
  double covered = 0.0;
  double sigma_mm = 0.0;
  double iterations = 0.0;
  int failures = 0;
};

// Bound about the centroid of all points (the tangent of every pose step here).
Mat6 cramer_rao_bound(const Scan& scan, std::size_t every_nth_is_outlier, const Vec3& pivot) {
  Mat6 information = Mat6::Zero();
  for (std::size_t i = 0; i < scan.point.size(); ++i) {
    if (every_nth_is_outlier && i % every_nth_is_outlier == 0) continue;
    Vec6 j;
    j << (scan.point[i] - pivot).cross(scan.normal[i]), scan.normal[i];
    information += j * j.transpose();
  }
  return kSigma_mm * kSigma_mm * information.inverse();
}

// The covariance of a result moved from its own pivot to `pivot`.
Mat6 about(const Mat6& covariance, const Vec3& from, const Vec3& pivot) {
  Mat6 change = Mat6::Identity();
  const Vec3 arm = pivot - from;
  change.block<3, 3>(3, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return change * covariance * change.transpose();
}

Outcome run(const RegistrationTarget& target, const Scan& ideal, const RegistrationOptions& options,
            int trials, std::size_t every_nth_is_outlier) {
  Outcome outcome;
  const RigidTransform truth = shapes::some_pose();
  const Vec3 pivot = shapes::centroid_of(ideal.point);
  for (int trial = 0; trial < trials; ++trial) {
    Rng rng(1, static_cast<std::uint64_t>(trial), "noise");
    std::vector<Vec3> points = ideal.point;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool outlier = every_nth_is_outlier && i % every_nth_is_outlier == 0;
      const double noise = outlier ? kOutlier_mm * (2.0 * rng.uniform() - 1.0) : kSigma_mm * rng.normal();
      points[i] += noise * ideal.normal[i];
    }
    const ScanPoints scan = shapes::seen_from(truth, points);
    const RigidTransform start =
        shapes::displaced(truth, 0.2, 0.2 * shapes::kPi / 180.0, pivot, 3, static_cast<std::uint64_t>(trial));
    const RegistrationResult result = register_scan(target, scan, start, options);
    if (!is_converged(result.termination)) ++outcome.failures;
    const Vec6 error = step_between(truth, result.part_from_mcs, pivot);
    outcome.mean += error / trials;
    outcome.spread += error * error.transpose() / trials;
    const Mat6 covariance = about(result.covariance, result.centroid_part_mm, pivot);
    outcome.covered += error.dot(covariance.ldlt().solve(error)) < kChiSquare95 ? 1.0 / trials : 0.0;
    outcome.sigma_mm += result.sigma_mm / trials;
    outcome.iterations += static_cast<double>(result.iterations) / trials;
  }
  outcome.spread -= outcome.mean * outcome.mean.transpose();
  return outcome;
}

void print(const std::string& name, const Outcome& o, const Mat6& bound) {
  fmt::print("| {} ", name);
  for (int k = 0; k < 6; ++k) fmt::print("| {:.3f} ", std::sqrt(o.spread(k, k) / bound(k, k)));
  double bias = 0.0;
  for (int k = 0; k < 6; ++k) bias = std::max(bias, std::abs(o.mean[k]) / std::sqrt(bound(k, k)));
  fmt::print("| {:.3f} | {:.1f} % | {:.3f} | {:.1f} | {} |\n", bias, 100.0 * o.covered,
             o.sigma_mm / kSigma_mm, o.iterations, o.failures);
  std::fflush(stdout);
}

}  // namespace
}  // namespace trueblade

int main(int argc, char** argv) {
  using namespace trueblade;
  const int trials = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int other_trials = argc > 2 ? std::atoi(argv[2]) : trials;
  const std::size_t points = argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3])) : 3400;
  const Part part = shapes::blade(96, 88);
  const RegistrationTarget target(part);
  const Scan scan = ideal_scan(part, points);
  const Vec3 pivot = shapes::centroid_of(scan.point);
  fmt::print("{} scans ({} for the other rules) of {} points, {} facets, sigma {} mm\n\n", trials,
             other_trials, scan.point.size(), part.model.facet_count(), kSigma_mm);
  fmt::print(
      "| case | rx | ry | rz | tx | ty | tz | largest bias | covered at 95 % | sigma found | iterations | "
      "not converged |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const auto row = [&](const std::string& name, const RegistrationOptions& options, int scans,
                       std::size_t every_nth) {
    print(name, run(target, scan, options, scans, every_nth), cramer_rao_bound(scan, every_nth, pivot));
  };
  row("default", preset("default"), trials, 0);
  row("default, 20 % outliers", preset("default"), trials, 5);
  for (const RejectionRule rule :
       {RejectionRule::none, RejectionRule::three_sigma, RejectionRule::worst_fraction,
        RejectionRule::least_median_of_squares, RejectionRule::tukey, RejectionRule::welsch}) {
    RegistrationOptions options = preset("default");
    options.rejection.rule = rule;
    row(to_string(rule), options, other_trials, 0);
    row(to_string(rule) + ", 20 % outliers", options, other_trials, 5);
  }
  return 0;
}
