// Rejection rules on samples whose quantiles are known, and the fit of one step with outliers.
#include "registration/rejection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "geometry/random.h"
#include "registration/fit_step.h"

namespace trueblade {
namespace {

// The n quantiles of a normal distribution with standard deviation sigma: an exact sample.
std::vector<double> normal_sample(std::size_t n, double sigma) {
  std::vector<double> sample(n);
  for (std::size_t i = 0; i < n; ++i)
    sample[i] = sigma * inverse_normal((static_cast<double>(i) + 0.5) / static_cast<double>(n));
  return sample;
}

RejectionScale apply(RejectionRule rule, const std::vector<double>& residual, std::vector<double>& weights) {
  RejectionOptions options;
  options.rule = rule;
  const std::vector<double> base(residual.size(), 1.0);
  weights.assign(residual.size(), -1.0);
  return apply_rejection(options, residual, base, 0.0, weights);
}

std::size_t kept(const std::vector<double>& weights) {
  return static_cast<std::size_t>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; }));
}

TEST(Rejection, ConsistentSigmaIsTheStandardDeviationOfANormalSample) {
  const auto sample = normal_sample(4000, 0.003);
  const std::vector<double> base(sample.size(), 1.0);
  // The median of 4,000 quantiles is within half a rank: 0.5 / 4000 / (2 * 0.318) of sigma.
  EXPECT_NEAR(consistent_sigma_mm(sample, base), 0.003, 0.003 * 2e-3);
}

TEST(Rejection, ConsistentSigmaHardlyMovesWithOutliers) {
  auto sample = normal_sample(4000, 0.003);
  for (std::size_t i = 0; i < sample.size(); i += 5) sample[i] = 100.0;
  const std::vector<double> base(sample.size(), 1.0);
  // The median of 80 % good points is their 62.5 % quantile: 0.887 / 0.6745 = 1.315 sigma.
  EXPECT_NEAR(consistent_sigma_mm(sample, base), 1.315 * 0.003, 0.003 * 0.01);
}

TEST(Rejection, EveryRuleKeepsTheShareOfANormalSampleThatItsCutLeaves) {
  const auto sample = normal_sample(10000, 0.003);
  std::vector<double> weights;
  apply(RejectionRule::none, sample, weights);
  EXPECT_EQ(kept(weights), 10000U);
  // |x| <= 4 sigma: all but 6.3e-5.
  apply(RejectionRule::consistent_cut, sample, weights);
  EXPECT_NEAR(static_cast<double>(kept(weights)), 9999.4, 1.0);
  // mean + 3 standard deviations of |x| = sqrt(2/pi) + 3 sqrt(1 - 2/pi) = 2.606 sigma: 0.9908 are left.
  const double cut = (std::sqrt(2.0 / M_PI) + 3.0 * std::sqrt(1.0 - 2.0 / M_PI)) * 0.003;
  EXPECT_NEAR(apply(RejectionRule::three_sigma, sample, weights).cut_mm, cut, 1e-3 * cut);
  EXPECT_NEAR(static_cast<double>(kept(weights)), 10000.0 * std::erf(cut / 0.003 / std::sqrt(2.0)), 3.0);
  apply(RejectionRule::worst_fraction, sample, weights);
  EXPECT_NEAR(static_cast<double>(kept(weights)), 9000.0, 2.0);
  apply(RejectionRule::least_median_of_squares, sample, weights);
  EXPECT_NEAR(static_cast<double>(kept(weights)), 10000.0 * std::erf(2.5 / std::sqrt(2.0)), 5.0);
}

TEST(Rejection, RedescendingWeightsAreTheTextbookOnes) {
  const auto sample = normal_sample(10001, 1.0);
  std::vector<double> weights;
  const double sigma = apply(RejectionRule::tukey, sample, weights).sigma_mm;
  for (const std::size_t i : {100UL, 5000UL, 7000UL}) {
    const double u = sample[i] / (4.685 * sigma);
    EXPECT_NEAR(weights[i], std::pow(1.0 - u * u, 2), 1e-14);
  }
  apply(RejectionRule::welsch, sample, weights);
  for (const std::size_t i : {100UL, 5000UL, 7000UL}) {
    const double u = sample[i] / (2.985 * sigma);
    EXPECT_NEAR(weights[i], std::exp(-u * u), 1e-14);
  }
}

TEST(Rejection, PointsWithoutWeightNeverComeBack) {
  auto sample = normal_sample(1000, 0.003);
  std::vector<double> base(sample.size(), 0.5), weights(sample.size());
  base[500] = 0.0;  // the smallest residual of all
  for (const auto& entry : choice_names(RejectionRule{})) {
    RejectionOptions options;
    options.rule = entry.choice;
    apply_rejection(options, sample, base, 0.0, weights);
    EXPECT_EQ(weights[500], 0.0) << entry.name;
    EXPECT_GT(weights[501], 0.0) << entry.name;
    EXPECT_LE(weights[501], 0.5) << entry.name;
  }
}

// Distances of points on the three inner sides of a box corner after a known step: an exactly linear model.
Correspondences linear_model(const Vec6& step, std::size_t count) {
  Correspondences c;
  c.frame = {Vec3(10, 10, 10), 10.0};
  c.jacobian.resize(6, static_cast<Eigen::Index>(count));
  c.closest.resize(count);
  Rng rng(1, 0, "linear model");
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 n = Vec3::Unit(static_cast<Eigen::Index>(i % 3));
    const Vec3 x(20.0 * rng.uniform(), 20.0 * rng.uniform(), 20.0 * rng.uniform());
    Vec6 j;
    j << (x - c.frame.pivot_part_mm).cross(n) / c.frame.radius_mm, n;
    c.jacobian.col(static_cast<Eigen::Index>(i)) = j;
    c.distance_mm.push_back(-j.dot(step));
  }
  return c;
}

TEST(FitStep, LeastMedianFindsTheStepBehindFortyPercentOneSidedOutliers) {
  const Vec6 step = (Vec6() << 0.3, -0.2, 0.1, 1.0, -2.0, 0.5).finished();
  Correspondences c = linear_model(step, 1000);
  Rng rng(2, 0, "outliers");
  for (std::size_t i = 0; i < 400; ++i) c.distance_mm[i] += 5.0 + 5.0 * rng.uniform();
  RejectionOptions options;
  options.rule = RejectionRule::least_median_of_squares;
  const std::vector<double> base(c.size(), 1.0);
  std::vector<double> weights(c.size());
  const StepFit fit =
      fit_step(c, base, options, FreeDirections::Identity(6, 6), 1e-12, false, std::nullopt, weights);
  EXPECT_LT((fit.step_scaled - step).norm(), 1e-9);
  EXPECT_EQ(kept(weights), 600U);
}

// Few points see the only large misplacement: their residuals are far beyond any cut, but the step explains
// them, so they must not be rejected.
TEST(FitStep, PointsThatTheStepExplainsAreNoOutliers) {
  Correspondences c = linear_model((Vec6() << 0, 0, 0, 0.01, 0.01, 3.0).finished(), 3000);
  std::vector<double> base(c.size(), 1.0), weights(c.size());
  for (std::size_t i = 2; i < c.size(); i += 3)
    if (i % 60 != 2) base[i] = 0.0;  // 50 of 2,050 points face z
  const StepFit fit = fit_step(c, base, RejectionOptions{}, FreeDirections::Identity(6, 6), 1e-12, false,
                               std::nullopt, weights);
  EXPECT_NEAR(fit.step_scaled[5], 3.0, 1e-9);
  EXPECT_EQ(kept(weights), 2050U);
}

// The step control compares the next objective with this one, so that both must be over the same points. With
// few points and heavy tails the selection often goes round in a circle and never repeats.
TEST(FitStep, WeightsAreThoseOfTheNormalEquations) {
  for (std::uint64_t trial = 0; trial < 2000; ++trial) {
    Rng random(3, trial, "fit step");
    Correspondences c = linear_model(Vec6::Zero(), 8 + trial % 60);
    for (double& d : c.distance_mm) d = random.normal() / (0.01 + random.uniform());
    const std::vector<double> base(c.size(), 1.0);
    std::vector<double> weights(c.size());
    const StepFit fit = fit_step(c, base, RejectionOptions{}, FreeDirections::Identity(6, 6), 1e-12,
                                 trial % 2 == 0, std::nullopt, weights);
    double squares = 0.0;
    for (std::size_t i = 0; i < c.size(); ++i) squares += weights[i] * c.distance_mm[i] * c.distance_mm[i];
    EXPECT_NEAR(fit.equations.weighted_squares, squares, 1e-12 * squares) << "trial " << trial;
    EXPECT_EQ(fit.equations.count, kept(weights)) << "trial " << trial;
  }
}

}  // namespace
}  // namespace trueblade
