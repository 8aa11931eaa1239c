#include "apps/deviation_error.h"

#include <cmath>

namespace trueblade {

void DeviationError::add(const Deviations& reported, std::size_t point, double true_mm) {
  if (reported.outliers.is_outlier[point] || std::isnan(true_mm)) return;
  const double error_mm = reported.signed_mm[point] - true_mm;
  squares += error_mm * error_mm;
  sum += error_mm;
  if (std::abs(error_mm) > std::abs(largest)) largest = error_mm;
  ++count;
}

double DeviationError::mean_mm() const {
  return count > 0 ? sum / static_cast<double>(count) : kNoValue;
}

double DeviationError::rms_mm() const {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : kNoValue;
}

double DeviationError::largest_mm() const {
  return count > 0 ? largest : kNoValue;
}

}  // namespace trueblade
