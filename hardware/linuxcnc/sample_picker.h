// Out of the samples of every servo period, the one for each planned position: the nearest taken while the
// controller was at that position's line of the program or at the next. Its position is the latched one, so
// that "nearest" costs no accuracy: it only decides where on the surface the point lies.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "hardware/linuxcnc/sample_frame.h"

namespace trueblade {

class SamplePicker {
 public:
  // `path` must outlive the picker.
  SamplePicker(std::span<const AxisPositions> path, std::uint64_t first_point)
      : path_(path), first_point_(static_cast<double>(first_point)) {}

  // Takes every sample in order; calls `pick` with the sample of each position as soon as the controller has
  // passed it. `pick` returns whether to go on. Throws MachineFault (protocol) when the controller goes
  // backwards or beyond the path.
  using Pick = std::function<bool(std::size_t position, const LatchedSample& sample)>;
  bool take(const LatchedSample& sample, const Pick& pick);

  // The program has said that it is at its end, and every position has been picked.
  bool finished() const { return begun_ && next_ == path_.size(); }
  bool begun() const { return begun_; }

 private:
  bool pick_up_to(std::size_t end, const Pick& pick);

  std::span<const AxisPositions> path_;
  double first_point_;
  bool begun_ = false;
  std::size_t next_ = 0;               // first position not yet picked
  std::optional<LatchedSample> best_;  // for it
  std::optional<LatchedSample> last_;
  double best_distance_ = 0.0;
};

// In mm; a turn counts as the travel of a point 100 mm from the rotary axis.
double distance_between(const AxisPositions& a, const AxisPositions& b);

}  // namespace trueblade
