#include "inspection/tolerance.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "geometry/error.h"

namespace trueblade {

void Tolerance::validate() const {
  if (!std::isfinite(lower_mm) || !std::isfinite(upper_mm) || !(lower_mm < upper_mm)) {
    throw InputError(fmt::format(
        "tolerance is {} to {} mm, must be finite with the lower limit below the upper", lower_mm, upper_mm));
  }
}

double ToleranceCounts::percent(std::size_t count) const {
  if (total() == 0) return std::numeric_limits<double>::quiet_NaN();
  return 100.0 * static_cast<double>(count) / static_cast<double>(total());
}

ToleranceCounts count_against(std::span<const double> deviations_mm, const std::vector<bool>& left_out,
                              const Tolerance& tolerance) {
  ToleranceCounts counts;
  for (std::size_t i = 0; i < deviations_mm.size(); ++i) {
    const bool over = deviations_mm[i] > tolerance.upper_mm, under = deviations_mm[i] < tolerance.lower_mm;
    if (!left_out.empty() && left_out[i]) {
      counts.outliers_outside += over || under ? 1 : 0;
    } else if (over) {
      ++counts.over;
    } else if (under) {
      ++counts.under;
    } else {
      ++counts.within;
    }
  }
  return counts;
}

}  // namespace trueblade
