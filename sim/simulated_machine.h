// The simulated backend: a four-axis machine whose true geometry, part and sensor are known to the simulation
// alone. What leaves it through the driver is what encoders and sensor would report.
//
// Every sample is a pure function of (seed, trial, number of its view, line and point): threads and the order
// in which samples are computed do not matter.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "hardware/axis_dynamics.h"
#include "hardware/machine_driver.h"
#include "hardware/machine_geometry.h"
#include "sim/machine_errors.h"
#include "sim/sensor_model.h"
#include "sim/true_machine.h"
#include "sim/virtual_part.h"
#include "sim/virtual_probe.h"

namespace trueblade {

struct VirtualSetup {
  MachineGeometry geometry;  // nominal
  AxisLimits limits{{-500.0, -500.0, -500.0, -100.0}, {500.0, 500.0, 500.0, 100.0}};
  AxisDynamics dynamics;
  Lens lens;
  RigidTransform part_from_mcs;     // where the part would be without fixture errors (preliminary)
  RigidTransform mcs_from_fixture;  // the frame in which the fixture's errors act
  MachineErrors errors;
  SensorModel sensor;
  double aperture_radius_mm = 0.0;  // of the probe; above 0: the part may cut off light (vignetting.h)
  std::uint64_t seed = 0;
  std::uint64_t trial = 0;
  std::uint32_t sensor_replicate = 0;  // of the sensor's draws, see GaussianError

  void validate() const;  // throws InputError
};

VirtualSetup validated(VirtualSetup setup);  // throws InputError
// What a set-up draws from: the true geometry, and the stream of the sensor's noise.
TrueMachine true_machine_of(const VirtualSetup& setup);
Rng sensor_stream_of(const VirtualSetup& setup);

// For evaluating experiments only; the program that measures never sees it.
struct SimulationTruth {
  RigidTransform part_from_mcs;  // true, of the view measured last: see TrueMachine::mcs_from_part
  // Per sample; nullopt: the beam met nothing, or the sample was measured before this run.
  std::vector<std::optional<TrueHit>> hits;
};

// One reading of the virtual probe: what the machine hands out, and the truth.
struct VirtualMeasurement {
  ProbeSample sample;
  std::optional<TrueHit> truth;
};
// Readings with the encoders at `at`. They are points number `first_point` and up: the number keys the draws
// of the errors and of `sensor_stream`, see sensor_stream_of. Precondition: measured.size() == at.size().
void measure_at(const VirtualPart& part, const VirtualSetup& setup, const TrueMachine& machine,
                const Rng& sensor_stream, std::span<const AxisState> at, std::uint64_t first_point,
                std::span<VirtualMeasurement> measured);

class SimulatedMachine final : public MachineDriver {
 public:
  // Throws InputError when the set-up is not valid.
  SimulatedMachine(VirtualPart part, VirtualSetup setup);

  void connect() override;
  void home() override;
  void move_to(const AxisPositions& target) override;
  ProbeSample measure_point() override;
  std::size_t scan_line(std::span<const AxisPositions> path, const SampleSink& sink) override;
  void skip_measured(const MeasuredBefore& before) override;
  void stop() noexcept override;
  MachineState state() const override { return state_; }
  AxisPositions position() const override { return at_; }
  AxisLimits limits() const override { return setup_.limits; }

  // The truth of the samples taken since the last call (or since construction), in the order taken. Call it
  // once after each view.
  SimulationTruth take_truth();

 private:
  void require_ready() const;
  void require_within_limits(const AxisPositions& target) const;
  void turn_to(double theta_rad);
  VirtualPart part_;
  VirtualSetup setup_;
  TrueMachine true_machine_;
  Rng sensor_stream_;
  std::atomic<MachineState> state_{MachineState::disconnected};
  AxisPositions at_;
  double clock_s_ = 0.0;
  std::vector<AxisPositions> run_up_;              // of a line that is gone on with: passed before this run
  std::uint64_t view_ = 0, line_ = 0, point_ = 0;  // running numbers: the keys of the draws
  std::vector<std::optional<TrueHit>> hits_;
  // Of the line being scanned; kept, so that a line finds the memory of the one before.
  std::vector<AxisState> at_samples_;
  std::vector<VirtualMeasurement> measured_;
};

}  // namespace trueblade
