// The covariance against closed forms and against the scatter of repeated scans.
#include "registration/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

#include "registration/register_scan.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

TEST(UntruncatedSigma, UndoesTheTruncationOfANormalDistribution) {
  for (const double k : {1.5, 2.0, 2.606, 3.0, 4.0, 8.0}) {
    const double inside = std::erf(k / std::sqrt(2.0));
    const double density = std::exp(-0.5 * k * k) / std::sqrt(2.0 * M_PI);
    const double truncated = 0.003 * std::sqrt((inside - 2.0 * k * density) / inside);
    EXPECT_NEAR(untruncated_sigma_mm(truncated, k * 0.003), 0.003, 1e-12) << k;
  }
  EXPECT_EQ(untruncated_sigma_mm(0.003, std::numeric_limits<double>::infinity()), 0.003);
  EXPECT_EQ(untruncated_sigma_mm(0.0, 1.0), 0.0);
}

struct Ideal {
  Part part = shapes::blade(48, 44);
  std::vector<Vec3> point, normal;
  Vec3 pivot;
  Ideal() {
    point = shapes::points_on(part, 600, Vec3(0.3, 1.0, 0.4), 0.0, 7);
    const ClosestPointTree tree(part.model);
    for (const Vec3& p : point) normal.push_back(part.model.facet_normal(tree.query(p).facet));
    pivot = shapes::centroid_of(point);
  }
  ScanPoints noisy(double sigma_mm, std::uint64_t trial) const {
    Rng rng(8, trial, "noise");
    std::vector<Vec3> points = point;
    for (std::size_t i = 0; i < points.size(); ++i) points[i] += sigma_mm * rng.normal() * normal[i];
    return shapes::seen_from(shapes::some_pose(), points);
  }
};

Mat6 about(const Mat6& covariance, const Vec3& from, const Vec3& pivot) {
  Mat6 change = Mat6::Identity();
  const Vec3 arm = pivot - from;
  change.block<3, 3>(3, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return change * covariance * change.transpose();
}

#ifdef __SANITIZE_ADDRESS__
constexpr int kScans = 20;  // a scan takes twenty times longer, and it is the memory that is looked at
#else
constexpr int kScans = 300;
#endif

// error' covariance^-1 error is chi-square with six degrees of freedom: its mean is 6 with a standard error
// of sqrt(12 / scans).
TEST(PoseCovariance, DescribesTheScatterOfRepeatedScansForEveryRuleAndNoiseModel) {
  const Ideal ideal;
  const RegistrationTarget target(ideal.part);
  const RigidTransform truth = shapes::some_pose();
  std::map<std::string, RegistrationOptions> cases;
  for (const RejectionRule rule :
       {RejectionRule::none, RejectionRule::consistent_cut, RejectionRule::three_sigma,
        RejectionRule::worst_fraction, RejectionRule::least_median_of_squares, RejectionRule::tukey,
        RejectionRule::welsch}) {
    RegistrationOptions options = preset("default");
    options.rejection.rule = rule;
    cases[to_string(rule)] = options;
  }
  cases["from residuals"] = preset("default");
  cases["from residuals"].covariance.noise = NoiseModel::from_residuals;
  cases["given"] = preset("default");
  cases["given"].covariance.sigma_mm = 0.003;
  for (const auto& [name, options] : cases) {
    double mean = 0.0;
    for (int trial = 0; trial < kScans; ++trial) {
      const auto result =
          register_scan(target, ideal.noisy(0.003, static_cast<std::uint64_t>(trial)), truth, options);
      const Vec6 error = step_between(truth, result.part_from_mcs, ideal.pivot);
      mean += error.dot(about(result.covariance, result.centroid_part_mm, ideal.pivot).ldlt().solve(error)) /
              kScans;
    }
    // Four standard errors; the residuals' own squares estimate each variance from few points and lose a
    // little.
    EXPECT_NEAR(mean, 6.0, 4.0 * std::sqrt(12.0 / kScans)) << name;
  }
}

// Points of unequal noise, sigma / sqrt(snr), weighted by their SNR: the model that says so, and the one that
// takes every point by its own residual.
TEST(PoseCovariance, DescribesTheScatterOfWeightedScans) {
  const Ideal ideal;
  const RegistrationTarget target(ideal.part);
  const RigidTransform truth = shapes::some_pose();
  for (const NoiseModel noise : {NoiseModel::inverse_to_weight, NoiseModel::from_residuals}) {
    RegistrationOptions options = preset("default");
    options.covariance.noise = noise;
    options.rejection.rule = RejectionRule::none;
    double mean = 0.0;
    for (std::uint64_t trial = 0; trial < kScans; ++trial) {
      Rng rng(12, trial, "weighted noise");
      std::vector<Vec3> points = ideal.point;
      std::vector<double> snr;
      for (std::size_t i = 0; i < points.size(); ++i) {
        snr.push_back(0.1 + 0.9 * rng.uniform());
        points[i] += 0.003 / std::sqrt(snr.back()) * rng.normal() * ideal.normal[i];
      }
      ScanPoints scan = shapes::seen_from(truth, points);
      scan.snr = snr;
      const auto result = register_scan(target, scan, truth, options);
      const Vec6 error = step_between(truth, result.part_from_mcs, ideal.pivot);
      mean += error.dot(about(result.covariance, result.centroid_part_mm, ideal.pivot).ldlt().solve(error)) /
              kScans;
    }
    EXPECT_NEAR(mean, 6.0, 4.0 * std::sqrt(12.0 / kScans)) << to_string(noise);
  }
}

TEST(PoseCovariance, GivenSigmaScalesIt) {
  const Ideal ideal;
  const RegistrationTarget target(ideal.part);
  RegistrationOptions options = preset("default");
  options.covariance.sigma_mm = 0.003;
  const auto a = register_scan(target, ideal.noisy(0.003, 1), shapes::some_pose(), options);
  options.covariance.sigma_mm = 0.006;
  const auto b = register_scan(target, ideal.noisy(0.003, 1), shapes::some_pose(), options);
  EXPECT_FALSE(a.sigma_estimated);
  EXPECT_TRUE(b.covariance.isApprox(4.0 * a.covariance, 1e-12));
}

}  // namespace
}  // namespace trueblade
