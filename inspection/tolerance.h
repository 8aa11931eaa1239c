// Limits of the signed deviation and how many points keep them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace trueblade {

// Of the signed deviation, positive outside the material; an equal bilateral profile tolerance t is -t/2 to
// t/2. Unequal limits are allowed. Points on a limit keep it.
struct Tolerance {
  double lower_mm;
  double upper_mm;
  void validate() const;  // throws InputError: finite, lower below upper
};

struct ToleranceCounts {
  std::size_t within = 0;
  std::size_t over = 0;
  std::size_t under = 0;
  std::size_t outliers_outside = 0;  // left out, but over or under: someone has to look at them

  std::size_t total() const { return within + over + under; }
  double percent(std::size_t count) const;  // of the total; NaN when there is none
};

// `left_out` (the outliers) is empty (all points count) or one flag per point.
ToleranceCounts count_against(std::span<const double> deviations_mm, const std::vector<bool>& left_out,
                              const Tolerance& tolerance);

}  // namespace trueblade
