#include "geometry/robust_sigma.h"

#include <cmath>
#include <numbers>

namespace trueblade {

Truncation truncation_at(double k) {
  if (!(k < 38.0)) return {};  // the density underflows
  const double density = std::exp(-0.5 * k * k) / std::sqrt(2.0 * std::numbers::pi);
  const double inside = std::erf(k / std::numbers::sqrt2);
  return {inside, inside - 2.0 * k * density};
}

}  // namespace trueblade
