// Statistics of signed deviations, as reports of 3-D comparisons give them. All lengths in mm; serial sums in
// the order of the points, so that the numbers do not depend on threads.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace trueblade {

inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

// Of the points that are not left out. Numbers that do not exist (no point; one point for the standard
// deviation; no positive point for the mean of the positive) are kNoValue, and are written as null.
struct DeviationStatistics {
  std::size_t points = 0;  // measured
  std::size_t left_out = 0;
  double min_mm = kNoValue;
  double max_mm = kNoValue;
  double mean_mm = kNoValue;
  double rms_mm = kNoValue;                 // about zero: sqrt(mean of squares)
  double standard_deviation_mm = kNoValue;  // about the mean, divided by n - 1
  double mean_positive_mm = kNoValue;
  double mean_negative_mm = kNoValue;
};

// `left_out` is empty (all points count) or one flag per point.
DeviationStatistics statistics_of(std::span<const double> deviations_mm, const std::vector<bool>& left_out);

struct Histogram {
  double lower_mm = 0.0;
  double upper_mm = 0.0;
  std::vector<std::size_t> counts;  // equal bins from lower to upper; a bin holds its lower edge
  std::size_t below = 0;
  std::size_t above = 0;  // the upper edge itself counts in the last bin
};

// Precondition: lower_mm < upper_mm, bins > 0. Points left out are in no bin.
Histogram histogram_of(std::span<const double> deviations_mm, const std::vector<bool>& left_out,
                       double lower_mm, double upper_mm, std::size_t bins);

// The rule of the report (paper, Fig. 8): a measurement is an outlier when its signed deviation lies more
// than three standard deviations from the mean of all signed deviations, all measurements counted, once. The
// paper says "absolute distance"; after a best fit the mean is next to zero and the two readings agree,
// before one only this reading makes sense (a constant offset has no outliers). It is not the rule of the
// registration, which takes the unsigned distances in every iteration (section 3.1).
struct ReportOutliers {
  std::vector<bool> is_outlier;  // per point
  std::size_t count = 0;
  double lower_limit_mm = kNoValue;
  double upper_limit_mm = kNoValue;
};
ReportOutliers report_outliers(std::span<const double> deviations_mm);

}  // namespace trueblade
