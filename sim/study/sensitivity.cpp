#include "sim/study/sensitivity.h"

#include <cmath>
#include <vector>

namespace trueblade {
namespace {

// The ratio of two sums of paired terms, with its standard error by the jackknife (Efron and Stein 1981): how
// the ratio scatters when each pair in turn is left out. Error propagation of first order is 10 % too small
// at 20 trials, where the denominator's own scatter counts.
struct Ratio {
  double value;
  double standard_error;
};

Ratio ratio_of_sums(std::span<const double> numerators, std::span<const double> denominators) {
  double top = 0.0, bottom = 0.0;
  for (std::size_t i = 0; i < numerators.size(); ++i) {
    top += numerators[i];
    bottom += denominators[i];
  }
  if (bottom == 0.0) return {0.0, 0.0};
  const auto n = static_cast<double>(numerators.size());
  std::vector<double> without;
  double mean = 0.0;
  for (std::size_t i = 0; i < numerators.size(); ++i) {
    const double rest = bottom - denominators[i];
    without.push_back(rest > 0.0 ? (top - numerators[i]) / rest : 0.0);
    mean += without.back() / n;
  }
  double squares = 0.0;
  for (const double ratio : without) squares += (ratio - mean) * (ratio - mean);
  return {top / bottom, std::sqrt((n - 1.0) / n * squares)};
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
  const Ratio s = ratio_of_sums(first, variance);
  const Ratio t = ratio_of_sums(total, variance);
  return {s.value, s.standard_error, t.value, t.standard_error};
}

}  // namespace trueblade
