#include "sim/study/sensitivity.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "geometry/random.h"
#include "sim/study/paired.h"

namespace trueblade {
namespace {

constexpr std::size_t kTrials = 20000;
using Inputs = std::array<double, 3>;  // uniform in (0, 1)

SobolIndex index_of(std::size_t source, const std::function<double(const Inputs&)>& model) {
  std::vector<double> a(kTrials), b(kTrials), ab(kTrials);
  for (std::size_t i = 0; i < kTrials; ++i) {
    Rng rng_a(1, i, "A"), rng_b(1, i, "B");
    Inputs x, y;
    for (double& value : x) value = rng_a.uniform();
    for (double& value : y) value = rng_b.uniform();
    a[i] = model(x);
    b[i] = model(y);
    x[source] = y[source];
    ab[i] = model(x);
  }
  return sobol_index(a, b, ab);
}

TEST(SobolIndex, LinearModelSharesItsVariance) {
  // Variances 16 : 4 : 1 of uniform inputs.
  const auto model = [](const Inputs& x) { return 1000.0 + 4.0 * x[0] + 2.0 * x[1] + x[2]; };
  const std::array<double, 3> share{16.0 / 21.0, 4.0 / 21.0, 1.0 / 21.0};
  for (std::size_t source = 0; source < 3; ++source) {
    const SobolIndex index = index_of(source, model);
    EXPECT_NEAR(index.first_order, share[source], 5.0 * index.first_order_error) << source;
    EXPECT_NEAR(index.total, share[source], 5.0 * index.total_error) << source;
    EXPECT_LT(index.first_order_error, 0.02);
    EXPECT_LT(index.total_error, 0.02);
  }
}

// Few trials of y = 4 x1 + 2 x2, normal, whose indices are 0.8 and 0.2: over many repetitions the indices
// must scatter as their standard errors say.
TEST(SobolIndex, ScattersAsItsStandardErrorSays) {
  constexpr std::size_t kFew = 20, kRepetitions = 2000;
  const std::array<double, 2> factor{4.0, 2.0}, share{0.8, 0.2};
  for (std::size_t source = 0; source < 2; ++source) {
    std::vector<SobolIndex> found;
    for (std::size_t r = 0; r < kRepetitions; ++r) {
      std::vector<double> a(kFew), b(kFew), ab(kFew);
      for (std::size_t i = 0; i < kFew; ++i) {
        Rng rng(r, i, "A and B");
        std::array<double, 2> x{rng.normal(), rng.normal()}, y{rng.normal(), rng.normal()};
        a[i] = factor[0] * x[0] + factor[1] * x[1];
        b[i] = factor[0] * y[0] + factor[1] * y[1];
        x[source] = y[source];
        ab[i] = factor[0] * x[0] + factor[1] * x[1];
      }
      found.push_back(sobol_index(a, b, ab));
    }
    const auto expect_agreement = [&](double SobolIndex::*index, double SobolIndex::*error) {
      double mean = 0.0, squares = 0.0, stated = 0.0;
      for (const SobolIndex& one : found) {
        mean += one.*index / kRepetitions;
        stated += one.*error / kRepetitions;
      }
      for (const SobolIndex& one : found) squares += (one.*index - mean) * (one.*index - mean);
      const double scatter = std::sqrt(squares / (kRepetitions - 1));
      // The scatter of 2,000 values is known to 1.6 % where they are normal; these have longer tails.
      // Observed: within 4 %, where error propagation states 8 to 10 % too little.
      EXPECT_NEAR(stated, scatter, 0.06 * scatter) << source;
      // Ratios of means are biased by the order of 1 / n.
      EXPECT_NEAR(mean, share[source], 1.0 / kFew) << source;
    };
    expect_agreement(&SobolIndex::first_order, &SobolIndex::first_order_error);
    expect_agreement(&SobolIndex::total, &SobolIndex::total_error);
  }
}

TEST(SobolIndex, IshigamiFunction) {
  // sin x1 + a sin^2 x2 + b x3^4 sin x1 over (-pi, pi), the usual test; its indices are known (Homma and
  // Saltelli 1996).
  constexpr double a = 7.0, b = 0.1, pi = std::numbers::pi;
  const auto model = [](const Inputs& u) {
    const auto x = [&](std::size_t k) { return 2.0 * pi * (u[k] - 0.5); };
    const double sine = std::sin(x(1));
    return std::sin(x(0)) + a * sine * sine + b * std::pow(x(2), 4) * std::sin(x(0));
  };
  const double v1 = 0.5 * std::pow(1.0 + b * std::pow(pi, 4) / 5.0, 2), v2 = a * a / 8.0;
  const double v13 = b * b * std::pow(pi, 8) * 8.0 / 225.0, v = v1 + v2 + v13;
  const std::array<double, 3> first{v1 / v, v2 / v, 0.0}, total{(v1 + v13) / v, v2 / v, v13 / v};
  for (std::size_t source = 0; source < 3; ++source) {
    const SobolIndex index = index_of(source, model);
    EXPECT_NEAR(index.first_order, first[source], 5.0 * index.first_order_error) << source;
    EXPECT_NEAR(index.total, total[source], 5.0 * index.total_error) << source;
  }
}

TEST(SobolIndex, OfAConstantIsZero) {
  const std::vector<double> constant(10, 3.0);
  const SobolIndex index = sobol_index(constant, constant, constant);
  EXPECT_EQ(index.first_order, 0.0);
  EXPECT_EQ(index.total, 0.0);
}

TEST(PairedDifference, OfKnownValues) {
  const std::vector<double> first{1.0, 2.0, 3.0, 4.0}, second{2.0, 2.0, 4.0, 4.0};
  const PairedDifference d = paired_difference(first, second, 0.95);
  EXPECT_DOUBLE_EQ(d.mean, 0.5);
  EXPECT_NEAR(d.standard_error, std::sqrt(1.0 / 3.0 / 4.0), 1e-15);
  EXPECT_NEAR(d.confidence.high - d.mean, 1.959963984540054 * d.standard_error, 1e-12);
  EXPECT_FALSE(d.significant);
}

TEST(ShareInterval, AsPublished) {
  // Newcombe 1998, Table I, method 3: 81 of 263, 95 %: 0.2553 to 0.3662.
  const CoverageInterval interval = share_interval(81, 263, 0.95);
  EXPECT_NEAR(interval.low, 0.2553, 5e-5);
  EXPECT_NEAR(interval.high, 0.3662, 5e-5);
  EXPECT_GE(share_interval(0, 10, 0.95).low, 0.0);
}

}  // namespace
}  // namespace trueblade
