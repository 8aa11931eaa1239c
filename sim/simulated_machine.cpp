#include "sim/simulated_machine.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "sim/vignetting.h"

namespace trueblade {
namespace {

// Points measured together: what is known of them between the steps stays in the cache.
constexpr std::size_t kPointsTogether = 64;

}  // namespace

VirtualSetup validated(VirtualSetup setup) {
  setup.validate();
  return setup;
}

TrueMachine true_machine_of(const VirtualSetup& setup) {
  return TrueMachine(setup.geometry, setup.part_from_mcs.inverse(), setup.mcs_from_fixture, setup.errors,
                     setup.seed, setup.trial);
}

Rng sensor_stream_of(const VirtualSetup& setup) {
  return Rng(setup.seed, setup.trial, "sensor");
}

void VirtualSetup::validate() const {
  geometry.validate();
  limits.validate();
  dynamics.validate();
  lens.validate();
  errors.validate();
  sensor.validate();
  const double best_snr = signal_to_noise(sensor, 1.0);
  if (best_snr < sensor.missed_snr)
    throw InputError(fmt::format(
        "sensor: noise_to_signal is {}, which leaves an SNR of {:.3g} at the best place of a surface: below "
        "missed_snr ({}), so that the beam never returns",
        sensor.noise_to_signal, best_snr, sensor.missed_snr));
  if (!(aperture_radius_mm >= 0.0 && std::isfinite(aperture_radius_mm)))
    throw InputError(fmt::format("aperture_radius_mm is {}, must be at least 0", aperture_radius_mm));
  if (!is_finite(part_from_mcs)) throw InputError("part_from_mcs must be finite");
  if (!is_finite(mcs_from_fixture)) throw InputError("mcs_from_fixture must be finite");
  if (!limits.contains({}))
    throw InputError("the travel limits must contain the home position (0 on every axis)");
}

void measure_at(const VirtualPart& part, const VirtualSetup& setup, const TrueMachine& machine,
                const Rng& sensor_stream, std::span<const AxisState> at, std::uint64_t first_point,
                std::span<VirtualMeasurement> measured) {
  std::array<TrueMachine::Beam, kPointsTogether> beams;
  std::array<ProbeDraws, kPointsTogether> draws;
  std::array<Ray, kPointsTogether> rays;
  std::array<std::optional<PartHit>, kPointsTogether> hits;
  std::array<double, kPointsTogether> light;
  light.fill(1.0);
  for (std::size_t begin = 0; begin < at.size(); begin += kPointsTogether) {
    const std::size_t count = std::min(kPointsTogether, at.size() - begin);
    machine.beams_at(at.subspan(begin, count), first_point + begin, std::span(beams).first(count));
    draw_probe(sensor_stream, replicate_start(setup.sensor_replicate), first_point + begin,
               std::span(draws).first(count));
    for (std::size_t k = 0; k < count; ++k) rays[k] = beams[k].in_part;
    first_hits(part, std::span(rays).first(count), std::numeric_limits<double>::infinity(),
               std::span(hits).first(count));
    if (setup.aperture_radius_mm > 0.0)
      free_light(part, std::span(rays).first(count), std::span(hits).first(count), setup.aperture_radius_mm,
                 std::span(light).first(count));
    for (std::size_t k = 0; k < count; ++k) {
      const ProbeReading probe = read_probe(part, setup.sensor, setup.lens, rays[k],
                                            setup.sensor.exposure_s * beams[k].velocity_in_part_mm_per_s,
                                            draws[k], hits[k], light[k]);
      VirtualMeasurement& m = measured[begin + k];
      m.truth = probe.truth;
      m.sample = {at[begin + k].axes, 0.0, probe.reading.snr, at[begin + k].time_s, probe.reading.flags};
      if (probe.reading.flags.usable())
        m.sample.distance_mm =
            quantised_mm(setup.sensor, probe.reading.distance_mm + beams[k].distance_error_mm);
    }
  }
}

SimulatedMachine::SimulatedMachine(VirtualPart part, VirtualSetup setup)
    : part_(std::move(part)),
      setup_(validated(std::move(setup))),
      true_machine_(true_machine_of(setup_)),
      sensor_stream_(sensor_stream_of(setup_)) {}

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

void SimulatedMachine::turn_to(double theta_rad) {
  // A view begins when the part is turned.
  if (theta_rad != at_.theta_rad) true_machine_.begin_view(++view_, theta_rad);
  at_.theta_rad = theta_rad;
}

void SimulatedMachine::move_to(const AxisPositions& target) {
  require_ready();
  require_within_limits(target);
  clock_s_ += move_time_s(setup_.dynamics, at_, target);
  turn_to(target.theta_rad);
  at_ = target;
}

ProbeSample SimulatedMachine::measure_point() {
  require_ready();
  clock_s_ += 1.0 / setup_.lens.rate_hz;
  const AxisState standing{at_, {}, clock_s_};
  VirtualMeasurement measured;
  measure_at(part_, setup_, true_machine_, sensor_stream_, {&standing, 1}, point_++, {&measured, 1});
  hits_.push_back(measured.truth);
  return measured.sample;
}

std::size_t SimulatedMachine::scan_line(std::span<const AxisPositions> path, const SampleSink& sink) {
  require_ready();
  for (const AxisPositions& target : path) require_within_limits(target);
  if (path.empty()) return 0;
  true_machine_.begin_line(line_++, path.front().theta_rad);

  // In the motion of the whole line, also when its beginning was measured before.
  std::vector<AxisPositions> line = std::exchange(run_up_, {});
  const std::size_t passed_before = line.size();
  line.insert(line.end(), path.begin(), path.end());
  const std::vector<PassedPosition> motion =
      line_motion(setup_.dynamics, setup_.lens, passed_before > 0 ? line.front() : at_, line);
  const double start_s = passed_before > 0 ? clock_s_ - motion[passed_before - 1].time_s : clock_s_;
  at_samples_.resize(path.size());
  measured_.resize(path.size());
  const std::span<AxisState> at = at_samples_;
  const std::span<VirtualMeasurement> measured = measured_;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const PassedPosition& passed = motion[passed_before + k];
    at[k] = {path[k], passed.velocity_per_s, start_s + passed.time_s};
  }
  parallel_for_blocks(path.size(), kPointsTogether, [&](std::size_t begin, std::size_t end) {
    measure_at(part_, setup_, true_machine_, sensor_stream_, at.subspan(begin, end - begin), point_ + begin,
               measured.subspan(begin, end - begin));
  });

  std::size_t delivered = 0;
  while (delivered < path.size()) {
    if (state_ != MachineState::idle)
      throw MachineFault(MachineFault::Kind::interrupted, "the machine was stopped during a line");
    const VirtualMeasurement& m = measured[delivered];
    at_ = path[delivered];
    clock_s_ = at[delivered].time_s;
    hits_.push_back(m.truth);
    ++delivered;
    ++point_;
    if (!sink(m.sample)) break;
  }
  return delivered;
}

void SimulatedMachine::skip_measured(const MeasuredBefore& before) {
  turn_to(before.theta_rad);
  line_ += before.lines;
  point_ += before.samples;
  hits_.resize(hits_.size() + before.samples);
  run_up_.assign(before.of_line.begin(), before.of_line.end());
}

void SimulatedMachine::stop() noexcept {
  if (state_ == MachineState::idle || state_ == MachineState::moving) state_ = MachineState::stopped;
}

SimulationTruth SimulatedMachine::take_truth() {
  SimulationTruth truth;
  truth.part_from_mcs = true_machine_.mcs_from_part().inverse();
  truth.hits = std::exchange(hits_, {});
  return truth;
}

}  // namespace trueblade
