#include "inspection/statistics.h"

#include <algorithm>
#include <cmath>

namespace trueblade {
namespace {

bool is_left_out(const std::vector<bool>& left_out, std::size_t point) {
  return !left_out.empty() && left_out[point];
}

// Rounding of a coordinate of a metre, 2^-53 * 1000 mm = 1.1e-13 mm, times ten thousand for the operations
// behind a deviation: spread below it is arithmetic, and makes no outlier.
constexpr double kSmallestOutlierLimit_mm = 1e-9;

}  // namespace

DeviationStatistics statistics_of(std::span<const double> deviations_mm, const std::vector<bool>& left_out) {
  DeviationStatistics s;
  s.points = deviations_mm.size();
  double sum = 0.0, sum_of_squares = 0.0, sum_positive = 0.0, sum_negative = 0.0;
  std::size_t n = 0, positive = 0, negative = 0;
  for (std::size_t i = 0; i < deviations_mm.size(); ++i) {
    if (is_left_out(left_out, i)) continue;
    const double d = deviations_mm[i];
    if (n == 0) s.min_mm = s.max_mm = d;
    s.min_mm = std::min(s.min_mm, d);
    s.max_mm = std::max(s.max_mm, d);
    ++n;
    sum += d;
    sum_of_squares += d * d;
    if (d > 0.0) ++positive, sum_positive += d;
    if (d < 0.0) ++negative, sum_negative += d;
  }
  s.left_out = s.points - n;
  if (n == 0) return s;
  s.mean_mm = sum / static_cast<double>(n);
  s.rms_mm = std::sqrt(sum_of_squares / static_cast<double>(n));
  if (positive > 0) s.mean_positive_mm = sum_positive / static_cast<double>(positive);
  if (negative > 0) s.mean_negative_mm = sum_negative / static_cast<double>(negative);
  if (n < 2) return s;

  // A second pass about the mean: the difference of squares would lose digits when the mean is large.
  double squares_about_mean = 0.0;
  for (std::size_t i = 0; i < deviations_mm.size(); ++i) {
    if (is_left_out(left_out, i)) continue;
    squares_about_mean += (deviations_mm[i] - s.mean_mm) * (deviations_mm[i] - s.mean_mm);
  }
  s.standard_deviation_mm = std::sqrt(squares_about_mean / static_cast<double>(n - 1));
  return s;
}

Histogram histogram_of(std::span<const double> deviations_mm, const std::vector<bool>& left_out,
                       double lower_mm, double upper_mm, std::size_t bins) {
  Histogram h{lower_mm, upper_mm, std::vector<std::size_t>(bins, 0), 0, 0};
  const double bins_per_mm = static_cast<double>(bins) / (upper_mm - lower_mm);
  for (std::size_t i = 0; i < deviations_mm.size(); ++i) {
    if (is_left_out(left_out, i)) continue;
    const double d = deviations_mm[i];
    if (d < lower_mm) {
      ++h.below;
    } else if (d > upper_mm) {
      ++h.above;
    } else {
      ++h.counts[std::min(static_cast<std::size_t>((d - lower_mm) * bins_per_mm), bins - 1)];
    }
  }
  return h;
}

ReportOutliers report_outliers(std::span<const double> deviations_mm) {
  ReportOutliers outliers;
  outliers.is_outlier.assign(deviations_mm.size(), false);
  const DeviationStatistics all = statistics_of(deviations_mm, {});
  if (!(all.points > 1)) return outliers;

  const double limit_mm = std::max(3.0 * all.standard_deviation_mm, kSmallestOutlierLimit_mm);
  outliers.lower_limit_mm = all.mean_mm - limit_mm;
  outliers.upper_limit_mm = all.mean_mm + limit_mm;
  for (std::size_t i = 0; i < deviations_mm.size(); ++i) {
    if (std::abs(deviations_mm[i] - all.mean_mm) <= limit_mm) continue;
    outliers.is_outlier[i] = true;
    ++outliers.count;
  }
  return outliers;
}

}  // namespace trueblade
