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
  const auto distance_to_next = [&] { return distance_between(axis_positions(sample), path_[next_]); };
  const bool moves = sample.program_line >= kFirstPointLine;  // 0: stands at the start or at the end
  const bool backwards = moves && last_ && sample.program_line < last_->program_line;
  const std::size_t heading = moves ? static_cast<std::size_t>(sample.program_line - kFirstPointLine) : next_;
  if (backwards || heading >= path_.size())
    throw MachineFault(
        MachineFault::Kind::protocol,
        fmt::format("the controller is at line {} of its program, expected lines {} to {}",
                    sample.program_line, next_ + kFirstPointLine, path_.size() + kFirstPointLine - 1));
  begun_ = true;
  last_ = sample;
  // The controller heads for the next position from the middle of a blended corner on, and ahead of the
  // encoders: a position is behind when the controller heads for the next one and the distance grows, or for
  // the one after that.
  while (next_ < heading) {
    const bool is_behind = next_ + 1 < heading || (best_ && distance_to_next() > best_distance_);
    if (!is_behind) break;
    if (!pick_up_to(next_ + 1, pick)) return false;
  }
  const double distance = distance_to_next();
  if (!best_ || distance < best_distance_) {
    best_ = sample;
    best_distance_ = distance;
  }
  return true;
}

}  // namespace trueblade
