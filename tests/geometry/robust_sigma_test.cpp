// The constants of a normal distribution with outliers, against its quantile and against integration.
#include "geometry/robust_sigma.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/random.h"

namespace trueblade {
namespace {

TEST(RobustSigma, TheMedianOfMagnitudesIsTheThirdQuartile) {
  EXPECT_DOUBLE_EQ(kSigmaPerMedian * inverse_normal(0.75), 1.0);
}

// Simpson's rule over 2,000 intervals of k / 1000: its error is at most 2 k / 180 (k / 1000)^4 times the
// largest fourth derivative (of the density 3 / sqrt(2 pi), of x^2 times it 12 / sqrt(2 pi)): 2e-9 at k = 8.
TEST(RobustSigma, WhatACutLeavesIsTheIntegralOfTheDensity) {
  for (const double k : {0.5, 1.5, 3.0, 4.0, 8.0}) {
    double inside = 0.0, second = 0.0;
    constexpr int kIntervals = 2000;
    for (int i = 0; i <= kIntervals; ++i) {
      const double x = k * (2.0 * i / kIntervals - 1.0);
      const double weight = (i == 0 || i == kIntervals ? 1.0
                             : i % 2                   ? 4.0
                                                       : 2.0) *
                            (2.0 * k / kIntervals) / 3.0;
      const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
      inside += weight * density;
      second += weight * density * x * x;
    }
    EXPECT_NEAR(truncation_at(k).inside, inside, 2e-9) << k;
    EXPECT_NEAR(truncation_at(k).second, second, 2e-9) << k;
  }
}

TEST(RobustSigma, NoCutLeavesAll) {
  for (const double k : {50.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(truncation_at(k).inside, 1.0);
    EXPECT_EQ(truncation_at(k).second, 1.0);
  }
}

}  // namespace
}  // namespace trueblade
