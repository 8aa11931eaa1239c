#include "sim/study/sensitivity.h"

#include <cmath>
#include <vector>

namespace trueblade {
namespace {

// The ratio of two means of paired terms, with its standard error (first order of the error propagation).
struct Ratio {
  double value;
  double standard_error;
};

Ratio ratio_of_means(std::span<const double> numerators, std::span<const double> denominators) {
  const auto n = static_cast<double>(numerators.size());
  double top = 0.0, bottom = 0.0;
  for (std::size_t i = 0; i < numerators.size(); ++i) {
    top += numerators[i] / n;
    bottom += denominators[i] / n;
  }
  if (bottom == 0.0) return {0.0, 0.0};
  const double ratio = top / bottom;
  double squares = 0.0;
  for (std::size_t i = 0; i < numerators.size(); ++i) {
    const double residual = numerators[i] - ratio * denominators[i];
    squares += residual * residual;
  }
  return {ratio, std::sqrt(squares / (n - 1.0) / n) / bottom};
}

}  // namespace

SobolIndex sobol_index(std::span<const double> a, std::span<const double> b, std::span<const double> ab) {
  const auto n = static_cast<double>(a.size());
  double mean = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) mean += (a[i] + b[i]) / (2.0 * n);
  std::vector<double> variance(a.size()), first(a.size()), total(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double fa = a[i] - mean, fb = b[i] - mean, fab = ab[i] - mean;
    variance[i] = 0.5 * (fa * fa + fb * fb);
    first[i] = fb * (fab - fa);
    total[i] = 0.5 * (fa - fab) * (fa - fab);
  }
  const Ratio s = ratio_of_means(first, variance);
  const Ratio t = ratio_of_means(total, variance);
  return {s.value, s.standard_error, t.value, t.standard_error};
}

}  // namespace trueblade
