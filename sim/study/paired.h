// Two cases compared trial by trial: with common random numbers the difference scatters far less than either.
#pragma once

#include <cstddef>
#include <span>

#include "sim/study/statement.h"

namespace trueblade {

struct PairedDifference {
  std::size_t pairs = 0;
  double mean = 0.0;  // second minus first
  double standard_error = 0.0;
  CoverageInterval confidence{};  // of the mean difference
  bool significant = false;       // the interval does not hold zero
};

// Normal confidence interval of the mean (the number of pairs is large). Preconditions: the same trials in
// both, at least 2; 0 < probability < 1.
PairedDifference paired_difference(std::span<const double> first, std::span<const double> second,
                                   double probability);

// Confidence interval of a share (Wilson 1927): k of n.
CoverageInterval share_interval(std::size_t k, std::size_t n, double probability);

}  // namespace trueblade
