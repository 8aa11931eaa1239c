// The sums behind the normal equations, for a run of points: the hot loop, compiled once for every
// instruction set.
#pragma once

#include <cstddef>

namespace trueblade {

// With the row v = (J_0 .. J_5, d, 1) of a point: product[r][c] = sum w v_r v_c. Filled for r = 0 .. 6 and c
// >= r; what else holds numbers is not meant to be read.
struct WeightedProducts {
  double product[7][8] = {};
};

// `jacobian` holds six numbers a point, `distance` and `weight` one. Points of weight 0 are left out. Every
// sum is taken in the points' order by a multiplication and an addition, so that it has the same bits on
// every machine.
WeightedProducts weighted_products(const double* jacobian, const double* distance, const double* weight,
                                   std::size_t count);

}  // namespace trueblade
