#include "hardware/linuxcnc/sample_picker.h"

#include <fmt/format.h>

#include <cmath>

#include "hardware/linuxcnc/scan_program.h"

namespace trueblade {

double distance_between(const AxisPositions& a, const AxisPositions& b) {
  constexpr double kRadiusMm = 100.0;
  return std::hypot(std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm, a.z_mm - b.z_mm),
                    kRadiusMm * (a.theta_rad - b.theta_rad));
}

bool SamplePicker::pick_up_to(std::size_t end, const Pick& pick) {
  while (next_ < end) {
    // The controller leaves out moves of no length: then the last sample stands there already.
    const LatchedSample sample = best_ ? *best_ : *last_;
    best_.reset();
    if (!pick(next_++, sample)) return false;
  }
  return true;
}

bool SamplePicker::take(const LatchedSample& sample, const Pick& pick) {
  if (sample.first_point != first_point_) {
    if (!begun_) return true;
    return pick_up_to(path_.size(), pick);
  }
  // A sensor that has nothing new to say has not measured this position.
  if (last_ && sample.reading == last_->reading) return true;
  // Below the first point's line (also 0: no motion) the machine stands, at the start or at the end.
  std::size_t position = next_;
  if (sample.program_line >= kFirstPointLine)
    position = static_cast<std::size_t>(sample.program_line - kFirstPointLine);
  if (position < next_ || position >= path_.size())
    throw MachineFault(
        MachineFault::Kind::protocol,
        fmt::format("the controller is at line {} of its program, expected lines {} to {}",
                    sample.program_line, next_ + kFirstPointLine, path_.size() + kFirstPointLine - 1));
  begun_ = true;
  const bool go_on = pick_up_to(position, pick);
  const double distance = distance_between(axis_positions(sample), path_[position]);
  if (!best_ || distance < best_distance_) {
    best_ = sample;
    best_distance_ = distance;
  }
  last_ = sample;
  return go_on;
}

}  // namespace trueblade
