// Variance-based sensitivity (Sobol 1993): which share of the variance of a result each source has.
//
// With two independent sets of draws A and B of all sources, and AB_i, which takes source i from B and the
// others from A (Saltelli et al. 2010), the same trials give
//   first order  S_i = mean f(B) (f(AB_i) - f(A)) / V           (Saltelli et al. 2010, Table 2 b)
//   total        T_i = mean (f(A) - f(AB_i))^2 / (2 V)          (Jansen 1999)
// S_i is what the variance would lose if source i alone were known; T_i is what would remain if all others
// were. For a linear result both are equal and sum to 1.
#pragma once

#include <span>

namespace trueblade {

struct SobolIndex {
  double first_order;
  double first_order_error;  // standard error by the jackknife over the trials
  double total;
  double total_error;
};

// Trial by trial the same trials. V is the variance over A and B together; values are taken about their mean,
// which changes nothing but the scatter. A result that never varies has indices of 0.
// Preconditions: equal lengths of at least 2.
SobolIndex sobol_index(std::span<const double> a, std::span<const double> b, std::span<const double> ab);

}  // namespace trueblade
