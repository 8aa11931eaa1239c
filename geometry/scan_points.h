// A scan as registration and evaluation see it: points in the measurement coordinate system (MCS) and their
// quality.
#pragma once

#include <vector>

#include "geometry/vector.h"

namespace trueblade {

struct ScanPoints {
  std::vector<Vec3> position_mcs_mm;
  std::vector<double> snr;  // signal-to-noise ratio in [0, 1], one per point, or empty when the file has none

  std::size_t size() const { return position_mcs_mm.size(); }
};

}  // namespace trueblade
