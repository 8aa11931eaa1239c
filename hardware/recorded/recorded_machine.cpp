#include "hardware/recorded/recorded_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace trueblade {
namespace {

// A continuous scan takes its samples on the clock, up to half a servo period's travel from the planned
// position and within the controller's path tolerance (0.03 mm at 50 mm/s); three times that. Plans that
// differ, differ by their raster's spacing.
constexpr double kSamePositionMm = 0.1;
constexpr double kSameAngleRad = 1e-3;

bool same_position(const AxisPositions& a, const AxisPositions& b) {
  return std::abs(a.x_mm - b.x_mm) <= kSamePositionMm && std::abs(a.y_mm - b.y_mm) <= kSamePositionMm &&
         std::abs(a.z_mm - b.z_mm) <= kSamePositionMm && std::abs(a.theta_rad - b.theta_rad) <= kSameAngleRad;
}

std::string words_for(const AxisPositions& axes) {
  return fmt::format("x {:.3f} y {:.3f} z {:.3f} mm theta {:.4f} rad", axes.x_mm, axes.y_mm, axes.z_mm,
                     axes.theta_rad);
}

}  // namespace

RecordedMachine::RecordedMachine(Journal journal, std::string name, const AxisLimits& limits)
    : name_(std::move(name)), limits_(limits) {
  for (const JournalledView& view : journal.views)
    samples_.insert(samples_.end(), view.samples.begin(), view.samples.end());
}

void RecordedMachine::connect() {
  state_ = MachineState::idle;
}

void RecordedMachine::home() {
  state_ = MachineState::idle;
}

void RecordedMachine::move_to(const AxisPositions& target) {
  at_ = target;
}

const ProbeSample& RecordedMachine::next_sample() {
  if (next_ == samples_.size())
    throw MachineFault(MachineFault::Kind::sensor,
                       fmt::format("{}: the journal ends after {} samples", name_, samples_.size()));
  return samples_[next_++];
}

ProbeSample RecordedMachine::measure_point() {
  return next_sample();
}

std::size_t RecordedMachine::scan_line(std::span<const AxisPositions> path, const SampleSink& sink) {
  std::size_t delivered = 0;
  for (const AxisPositions& planned : path) {
    const ProbeSample& sample = next_sample();
    if (!same_position(sample.axes, planned))
      throw MachineFault(
          MachineFault::Kind::protocol,
          fmt::format(
              "{}: sample {} was taken at {}, the plan asks for {}: the journal belongs to another plan",
              name_, next_, words_for(sample.axes), words_for(planned)));
    at_ = sample.axes;
    ++delivered;
    if (!sink(sample)) break;
  }
  return delivered;
}

void RecordedMachine::skip_measured(const MeasuredBefore& before) {
  next_ = std::min(samples_.size(), next_ + before.samples);
}

void RecordedMachine::stop() noexcept {}

}  // namespace trueblade
