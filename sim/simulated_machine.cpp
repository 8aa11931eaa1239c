#include "sim/simulated_machine.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/random.h"
#include "sim/true_geometry.h"

namespace trueblade {
namespace {

AxisPositions moved(const AxisPositions& at, const AxisPositions& velocity_per_s, double time_s) {
  return {at.x_mm + velocity_per_s.x_mm * time_s, at.y_mm + velocity_per_s.y_mm * time_s,
          at.z_mm + velocity_per_s.z_mm * time_s, at.theta_rad + velocity_per_s.theta_rad * time_s};
}

AxisPositions mean_velocity(const AxisPositions& from, const AxisPositions& to, double time_s) {
  return {(to.x_mm - from.x_mm) / time_s, (to.y_mm - from.y_mm) / time_s, (to.z_mm - from.z_mm) / time_s,
          (to.theta_rad - from.theta_rad) / time_s};
}

}  // namespace

void VirtualSetup::validate() const {
  geometry.validate();
  dynamics.validate();
  lens.validate();
  errors.validate();
  sensor.validate();
  if (!is_finite(part_from_mcs)) throw InputError("part_from_mcs must be finite");
  if (!is_finite(mcs_from_fixture)) throw InputError("mcs_from_fixture must be finite");
  if (!limits.contains({}))
    throw InputError("the travel limits must contain the home position (0 on every axis)");
}

SimulatedMachine::SimulatedMachine(VirtualPart part, VirtualSetup setup)
    : part_(std::move(part)), setup_(std::move(setup)) {
  setup_.validate();
  for (const ErrorScope scope : {ErrorScope::setup, ErrorScope::view, ErrorScope::line})
    draw_errors(setup_.errors, scope, setup_.seed, setup_.trial, 0, errors_);
}

void SimulatedMachine::connect() {
  if (state_ == MachineState::disconnected) state_ = MachineState::not_homed;
}

void SimulatedMachine::home() {
  if (state_ == MachineState::disconnected)
    throw MachineFault(MachineFault::Kind::connection, "the machine is not connected");
  at_ = {};
  state_ = MachineState::idle;
}

void SimulatedMachine::require_ready() const {
  switch (state_.load()) {
    case MachineState::idle:
      return;
    case MachineState::disconnected:
      throw MachineFault(MachineFault::Kind::connection, "the machine is not connected");
    case MachineState::not_homed:
      throw MachineFault(MachineFault::Kind::not_homed, "the machine is not homed");
    default:
      throw MachineFault(MachineFault::Kind::interrupted, "the machine was stopped: home it to go on");
  }
}

void SimulatedMachine::require_within_limits(const AxisPositions& target) const {
  if (!setup_.limits.contains(target))
    throw MachineFault(
        MachineFault::Kind::limit,
        fmt::format("target x {:.3f} y {:.3f} z {:.3f} mm theta {:.5f} rad is beyond the limits", target.x_mm,
                    target.y_mm, target.z_mm, target.theta_rad));
}

void SimulatedMachine::move_to(const AxisPositions& target) {
  require_ready();
  require_within_limits(target);
  // A view begins when the part is turned.
  if (target.theta_rad != at_.theta_rad) {
    ++view_;
    draw_errors(setup_.errors, ErrorScope::view, setup_.seed, setup_.trial, view_, errors_);
  }
  clock_s_ += move_time_s(setup_.dynamics, at_, target);
  at_ = target;
}

ProbeSample SimulatedMachine::measure_point() {
  require_ready();
  clock_s_ += 1.0 / setup_.lens.rate_hz;
  const Measured measured = measure(at_, AxisPositions{}, clock_s_, point_++);
  hits_.push_back(measured.truth);
  return measured.sample;
}

std::size_t SimulatedMachine::scan_line(std::span<const AxisPositions> path, const SampleSink& sink) {
  require_ready();
  for (const AxisPositions& target : path) require_within_limits(target);
  if (path.empty()) return 0;
  draw_errors(setup_.errors, ErrorScope::line, setup_.seed, setup_.trial, line_++, errors_);

  std::vector<double> time_s(path.size());
  std::vector<AxisPositions> velocity(path.size());
  for (std::size_t k = 0; k < path.size(); ++k) {
    const AxisPositions& before = k == 0 ? at_ : path[k - 1];
    const double interval_s = sample_interval_s(setup_.dynamics, setup_.lens, before, path[k]);
    velocity[k] = mean_velocity(before, path[k], interval_s);
    time_s[k] = (k == 0 ? clock_s_ : time_s[k - 1]) + interval_s;
  }
  std::vector<Measured> measured(path.size());
  parallel_for_blocks(path.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      measured[k] = measure(path[k], velocity[k], time_s[k], point_ + k);
  });

  std::size_t delivered = 0;
  while (delivered < path.size()) {
    if (state_ != MachineState::idle)
      throw MachineFault(MachineFault::Kind::interrupted, "the machine was stopped during a line");
    const Measured& m = measured[delivered];
    at_ = path[delivered];
    clock_s_ = time_s[delivered];
    hits_.push_back(m.truth);
    ++delivered;
    ++point_;
    if (!sink(m.sample)) break;
  }
  return delivered;
}

void SimulatedMachine::stop() noexcept {
  if (state_ == MachineState::idle || state_ == MachineState::moving) state_ = MachineState::stopped;
}

SimulatedMachine::Measured SimulatedMachine::measure(const AxisPositions& encoders,
                                                     const AxisPositions& velocity_per_s, double time_s,
                                                     std::uint64_t point) const {
  ErrorValues errors = errors_;
  draw_errors(setup_.errors, ErrorScope::point, setup_.seed, setup_.trial, point, errors);

  const AxisPositions axes = moved(encoders, velocity_per_s, errors[ErrorSource::time_base]);
  const RigidTransform stage_from_part =
      true_stage_from_mcs(setup_.geometry, axes.theta_rad, errors) *
      true_mcs_from_part(setup_.part_from_mcs.inverse(), setup_.mcs_from_fixture, errors);
  const RigidTransform part_from_probe =
      stage_from_part.inverse() * true_stage_from_probe(setup_.geometry, axes, errors, time_s);
  const Ray beam{part_from_probe.translation_mm,
                 part_from_probe.rotation * true_beam_direction(setup_.geometry, errors)};

  Measured measured{};
  measured.sample.axes = encoders;
  measured.sample.time_s = time_s;
  const auto hit = part_.caster->first_hit(beam, 0.0, std::numeric_limits<double>::infinity());
  if (!hit) {
    measured.sample.flags.missed = true;
    return measured;
  }
  // A facet seen from behind belongs to an open part: it scatters like its front.
  const double cosine = std::min(1.0, std::abs(hit->normal.dot(beam.direction)));
  measured.truth =
      TrueHit{hit->facet, beam.origin_mm + hit->range_mm * beam.direction, hit->range_mm, std::acos(cosine)};

  Rng sensor = Rng(setup_.seed, setup_.trial, "sensor").at(2 * point);
  const double speckle_deviate = sensor.normal();
  const double noise_deviate = sensor.normal();
  const SensorReading reading = read_sensor(setup_.sensor, setup_.lens, hit->range_mm,
                                            measured.truth->incidence_rad, speckle_deviate, noise_deviate);
  measured.sample.flags = reading.flags;
  measured.sample.snr = reading.snr;
  if (reading.flags.usable())
    measured.sample.distance_mm = reading.distance_mm + errors[ErrorSource::sensor_distance];
  return measured;
}

SimulationTruth SimulatedMachine::take_truth() {
  SimulationTruth truth;
  truth.part_from_mcs =
      true_mcs_from_part(setup_.part_from_mcs.inverse(), setup_.mcs_from_fixture, errors_).inverse();
  truth.hits = std::exchange(hits_, {});
  return truth;
}

}  // namespace trueblade
