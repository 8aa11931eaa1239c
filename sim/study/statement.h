// The statement of a Monte Carlo evaluation after GUM Supplement 1 (JCGM 101:2008): mean, standard
// uncertainty and coverage intervals from the discrete representation of the distribution (clauses 7.5
// to 7.7).
#pragma once

#include <cstddef>
#include <vector>

namespace trueblade {

struct CoverageInterval {
  double low;
  double high;
};

struct Statement {
  std::size_t trials = 0;
  double mean = 0.0;                  // 7.6, Eq. 16
  double standard_uncertainty = 0.0;  // 7.6, Eq. 17: the standard deviation of the values
  CoverageInterval symmetric{};       // 7.7.3: equal probability on both sides
  CoverageInterval shortest{};        // 7.7.4
};

// `values` in any order, all finite. Preconditions: 0 < probability < 1, and enough values for an interval to
// exist, see least_trials. Sums run over the sorted values, so that the result does not depend on the order.
Statement statement_of(std::vector<double> values, double probability);

// The least number of values for which both intervals are defined (7.7.2: 0 < q < M with q = pM rounded).
std::size_t least_trials(double probability);

// Half a unit in the last place of `uncertainty` written with so many significant digits (7.9.2).
// Precondition: uncertainty > 0.
double numerical_tolerance(double uncertainty, int significant_digits);

}  // namespace trueblade
