#include "sim/study/statement.h"

#include <algorithm>
#include <cmath>

namespace trueblade {
namespace {

// 7.7.2: the number of steps of the sorted values that an interval spans.
std::size_t interval_steps(std::size_t count, double probability) {
  return static_cast<std::size_t>(probability * static_cast<double>(count) + 0.5);
}

CoverageInterval symmetric_interval(const std::vector<double>& sorted, std::size_t steps) {
  // Clause 7.7.3 counts from 1: r = (M - q) / 2, rounded up.
  const std::size_t r = (sorted.size() - steps + 1) / 2;
  return {sorted[r - 1], sorted[r - 1 + steps]};
}

CoverageInterval shortest_interval(const std::vector<double>& sorted, std::size_t steps) {
  std::size_t first = 0;
  for (std::size_t r = 1; r + steps < sorted.size(); ++r)
    if (sorted[r + steps] - sorted[r] < sorted[first + steps] - sorted[first]) first = r;
  return {sorted[first], sorted[first + steps]};
}

}  // namespace

std::size_t least_trials(double probability) {
  std::size_t count = 2;
  while (interval_steps(count, probability) == 0 || interval_steps(count, probability) >= count) ++count;
  return count;
}

Statement statement_of(std::vector<double> values, double probability) {
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += value;
  Statement statement;
  statement.trials = values.size();
  statement.mean = sum / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - statement.mean) * (value - statement.mean);
  statement.standard_uncertainty = std::sqrt(squares / (count - 1.0));
  const std::size_t steps = interval_steps(values.size(), probability);
  statement.symmetric = symmetric_interval(values, steps);
  statement.shortest = shortest_interval(values, steps);
  return statement;
}

double numerical_tolerance(double uncertainty, int significant_digits) {
  // u = c * 10^l with c an integer of so many digits. Rounding c up to the next power of ten shifts l.
  int exponent = static_cast<int>(std::floor(std::log10(uncertainty))) + 1 - significant_digits;
  const double c = std::round(uncertainty / std::pow(10.0, exponent));
  if (c >= std::pow(10.0, significant_digits)) ++exponent;
  return 0.5 * std::pow(10.0, exponent);
}

}  // namespace trueblade
