// How far the deviations that a report gives are from those of the part that truly stood there: reported
// minus true, at every point that the report counts. The noise of the point is in it, and whatever of the
// machine's errors the pose has taken for the place of the part is not.
#pragma once

#include <cstddef>

#include "inspection/deviations.h"

namespace trueblade {

struct DeviationError {
  double squares = 0.0, sum = 0.0, largest = 0.0;  // largest by size, with its sign
  std::size_t count = 0;

  // `true_mm`: deviation of the true part from the nominal one at this point of the scan. A point that the
  // report leaves out as an outlier, or whose truth is not known (NaN), does not count.
  void add(const Deviations& reported, std::size_t point, double true_mm);

  // NaN of no point.
  double mean_mm() const;
  double rms_mm() const;
  double largest_mm() const;
};

}  // namespace trueblade
