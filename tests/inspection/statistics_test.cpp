// Covers: statistics against numbers worked out by hand, empty and single-point sets, points left out, the
// histogram's edges, the report's outlier rule on hand-made data.
#include "inspection/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trueblade {
namespace {

TEST(Statistics, AgreeWithNumbersWorkedOutByHand) {
  const std::vector<double> d{1.0, -2.0, 4.0, 0.0, -3.0};
  const DeviationStatistics s = statistics_of(d, {});
  EXPECT_EQ(s.points, 5U);
  EXPECT_EQ(s.left_out, 0U);
  EXPECT_EQ(s.min_mm, -3.0);
  EXPECT_EQ(s.max_mm, 4.0);
  EXPECT_EQ(s.mean_mm, 0.0);
  EXPECT_DOUBLE_EQ(s.rms_mm, std::sqrt(30.0 / 5.0));
  EXPECT_DOUBLE_EQ(s.standard_deviation_mm, std::sqrt(30.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.mean_positive_mm, 2.5);
  EXPECT_DOUBLE_EQ(s.mean_negative_mm, -2.5);
}

TEST(Statistics, LeavesOutWhatItIsTold) {
  const DeviationStatistics s = statistics_of(std::vector{1.0, 100.0, 3.0}, {false, true, false});
  EXPECT_EQ(s.points, 3U);
  EXPECT_EQ(s.left_out, 1U);
  EXPECT_EQ(s.max_mm, 3.0);
  EXPECT_EQ(s.mean_mm, 2.0);
}

TEST(Statistics, NumbersThatDoNotExistAreNotANumber) {
  const DeviationStatistics none = statistics_of({}, {});
  EXPECT_TRUE(std::isnan(none.min_mm) && std::isnan(none.max_mm) && std::isnan(none.mean_mm) &&
              std::isnan(none.rms_mm) && std::isnan(none.standard_deviation_mm));
  const DeviationStatistics one = statistics_of(std::vector{0.25}, {});
  EXPECT_EQ(one.mean_mm, 0.25);
  EXPECT_EQ(one.rms_mm, 0.25);
  EXPECT_TRUE(std::isnan(one.standard_deviation_mm));
  EXPECT_TRUE(std::isnan(one.mean_negative_mm));
}

TEST(Statistics, StandardDeviationKeepsItsDigitsFarFromZero) {
  // Mean 1e6, spread 1e-3: the difference of squares would leave no digit (1e12 * 2^-53 = 1e-4 mm2).
  const std::vector<double> d{1e6 - 1e-3, 1e6, 1e6 + 1e-3};
  // 1e6 is held to 1.2e-10, so that the spread of 1e-3 is known to 1.2e-7 of itself.
  EXPECT_NEAR(statistics_of(d, {}).standard_deviation_mm, 1e-3, 1e-3 * 3e-7);
}

TEST(Histogram, CountsEveryPointOnce) {
  const std::vector<double> d{-1.5, -1.0, -0.5, 0.0, 0.5, 0.99, 1.0, 1.5, 0.1};
  const Histogram h =
      histogram_of(d, {false, false, false, false, false, false, false, false, true}, -1.0, 1.0, 4);
  EXPECT_EQ(h.counts, (std::vector<std::size_t>{1, 1, 1, 3}));  // the upper edge is in the last bin
  EXPECT_EQ(h.below, 1U);
  EXPECT_EQ(h.above, 1U);
}

TEST(ReportOutliers, ThreeStandardDeviationsOfAllSignedDeviations) {
  // 99 values of +-1 in turn and one of 10: mean 0.11 - 0.01, variance close to 1.99; 3 sigma = 4.2.
  std::vector<double> d;
  for (int i = 0; i < 98; ++i) d.push_back(i % 2 ? 1.0 : -1.0);
  d.push_back(4.0);
  d.push_back(10.0);
  // mean = 14 / 100 = 0.14; sum of squares = 98 + 16 + 100 = 214; variance = (214 - 100 * 0.14^2) / 99.
  const double sigma = std::sqrt((214.0 - 100.0 * 0.14 * 0.14) / 99.0);
  const ReportOutliers o = report_outliers(d);
  EXPECT_EQ(o.count, 1U);
  EXPECT_FALSE(o.is_outlier[98]);  // 4 - 0.14 is below 3 sigma = 4.39
  EXPECT_TRUE(o.is_outlier[99]);
  EXPECT_NEAR(o.upper_limit_mm, 0.14 + 3.0 * sigma, 1e-12);  // 100 additions of numbers up to 10
  EXPECT_NEAR(o.lower_limit_mm, 0.14 - 3.0 * sigma, 1e-12);
}

TEST(ReportOutliers, LeavesAConstantOffsetAlone) {
  EXPECT_EQ(report_outliers(std::vector<double>(1000, 0.1)).count, 0U);
  EXPECT_EQ(report_outliers({}).count, 0U);
  EXPECT_EQ(report_outliers(std::vector{5.0}).count, 0U);
}

}  // namespace
}  // namespace trueblade
