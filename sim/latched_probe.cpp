#include "sim/latched_probe.h"

#include <cmath>

namespace trueblade {
namespace {

// Readings between lines draw from numbers that no scan reaches.
constexpr std::uint64_t kFreeReadings = std::uint64_t{1} << 48;
// Encoder noise of a standing axis is no turn (0.2 arc seconds).
constexpr double kSameAngleRad = 1e-6;

AxisPositions velocity_between(const LatchedProbe::Trigger& from, const LatchedProbe::Trigger& to) {
  const double time_s = to.time_s - from.time_s;
  if (!(time_s > 0.0)) return {};
  return {(to.axes.x_mm - from.axes.x_mm) / time_s, (to.axes.y_mm - from.axes.y_mm) / time_s,
          (to.axes.z_mm - from.axes.z_mm) / time_s, (to.axes.theta_rad - from.axes.theta_rad) / time_s};
}

}  // namespace

LatchedProbe::LatchedProbe(VirtualPart part, VirtualSetup setup)
    : part_(std::move(part)),
      setup_(validated(std::move(setup))),
      true_machine_(true_machine_of(setup_)),
      sensor_stream_(sensor_stream_of(setup_)) {}

void LatchedProbe::begin_line(const Trigger& trigger) {
  const double theta = trigger.axes.theta_rad;
  if (*trigger.first_point == 0 && trigger.line == 0) {
    view_ = 0;
    view_theta_rad_ = 0.0;  // where a machine that was just homed stands
    true_machine_.begin_view(view_, view_theta_rad_);
  }
  if (std::abs(theta - view_theta_rad_) > kSameAngleRad) {
    true_machine_.begin_view(++view_, theta);
    view_theta_rad_ = theta;
  }
  true_machine_.begin_line(trigger.line, theta);
  first_point_ = trigger.first_point;
  position_ = 0;
}

ProbeSample LatchedProbe::measure(const Trigger& trigger) {
  if (!trigger.first_point) first_point_.reset();
  if (trigger.first_point && trigger.first_point != first_point_) begin_line(trigger);
  if (trigger.position) position_ = *trigger.position;
  const std::uint64_t point = first_point_ ? *first_point_ + position_ : kFreeReadings + free_readings_++;
  const AxisPositions velocity = last_ ? velocity_between(*last_, trigger) : AxisPositions{};
  last_ = trigger;
  const AxisState at{trigger.axes, velocity, trigger.time_s};
  VirtualMeasurement measured;
  measure_at(part_, setup_, true_machine_, sensor_stream_, {&at, 1}, point, {&measured, 1});
  return measured.sample;
}

}  // namespace trueblade
