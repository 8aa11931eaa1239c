#include "sim/study/paired.h"

#include <algorithm>
#include <cmath>

#include "geometry/random.h"

namespace trueblade {

PairedDifference paired_difference(std::span<const double> first, std::span<const double> second,
                                   double probability) {
  const auto n = static_cast<double>(first.size());
  PairedDifference result;
  result.pairs = first.size();
  for (std::size_t i = 0; i < first.size(); ++i) result.mean += (second[i] - first[i]) / n;
  double squares = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double residual = second[i] - first[i] - result.mean;
    squares += residual * residual;
  }
  result.standard_error = std::sqrt(squares / (n - 1.0) / n);
  const double reach = inverse_normal(0.5 + 0.5 * probability) * result.standard_error;
  result.confidence = {result.mean - reach, result.mean + reach};
  result.significant = result.confidence.low > 0.0 || result.confidence.high < 0.0;
  return result;
}

CoverageInterval share_interval(std::size_t k, std::size_t n, double probability) {
  const double z = inverse_normal(0.5 + 0.5 * probability);
  const auto count = static_cast<double>(n);
  const double share = static_cast<double>(k) / count;
  const double centre = (share + z * z / (2.0 * count)) / (1.0 + z * z / count);
  const double reach =
      z / (1.0 + z * z / count) * std::sqrt(share * (1.0 - share) / count + z * z / (4.0 * count * count));
  return {std::max(0.0, centre - reach), std::min(1.0, centre + reach)};
}

}  // namespace trueblade
