// The linuxcnc backend: a machine under the LinuxCNC motion controller.
//
// Two connections: linuxcncrsh carries commands and the controller's words; trueblade-hal, a component beside
// the controller, sends every servo period's axis positions latched with the probe's reading, and takes
// programs. A line is one program in continuous motion; which sample belongs to which planned position is
// told by the program line latched with it (sample_picker.h), so that no delay of network or program becomes
// a position error.
//
// What ends motion: stop() and every fault hold the feed in the next servo period and abort the program; when
// this program dies, hangs or is cut off, the controller's own watchdog does the same within half a second
// (SampleStream::kWatchdogS). Homing too. A fault leaves the state `stopped` when the encoders were seen to
// stand still, else `unknown`.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

#include "hardware/axis_dynamics.h"
#include "hardware/linuxcnc/rsh_client.h"
#include "hardware/linuxcnc/sample_picker.h"
#include "hardware/linuxcnc/sample_stream.h"
#include "hardware/machine_driver.h"

namespace trueblade {

struct LinuxCncSettings {
  RshAccess commands;
  std::uint16_t sample_port = 5008;  // of trueblade-hal, on the same host
  double home_timeout_s = 120.0;
  double sensor_timeout_s = 1.0;  // without a new reading while one is needed
  double scan_speed_mm_per_s = 50.0;
  // Whether home() may reset an e-stop and switch the machine on. Otherwise someone at the machine does.
  bool reset_estop = false;

  void validate() const;  // throws InputError naming the field
};

class LinuxCncMachine final : public MachineDriver {
 public:
  // `travel`: the machine file's limits; the machine obeys these and the controller's own. `dynamics` tells
  // how long a motion may take before it is given up.
  LinuxCncMachine(const LinuxCncSettings& settings, const AxisLimits& travel, const AxisDynamics& dynamics);
  ~LinuxCncMachine() override;

  // Moves nothing. Throws MachineFault, also when the controller does not count in mm and degrees.
  void connect() override;
  void home() override;
  void move_to(const AxisPositions& target) override;
  void move_through(std::span<const AxisPositions> way) override;
  ProbeSample measure_point() override;
  // The samples are taken on the servo clock: each lies within the path tolerance of the path and half a
  // servo period's travel of the planned position (0.03 mm at 50 mm/s), and says where.
  std::size_t scan_line(std::span<const AxisPositions> path, const SampleSink& sink) override;
  void skip_measured(const MeasuredBefore& before) override;
  void stop() noexcept override;
  MachineState state() const override { return state_; }
  AxisPositions position() const override;
  AxisLimits limits() const override;

  // Asked all the while the machine homes or moves, in the thread that moves it: true ends the motion with a
  // MachineFault (interrupted).
  void stop_when(std::function<bool()> asked) { stop_when_ = std::move(asked); }

  // The samples as they come, whether or not anything moves: for bring-up. Precondition: connected.
  std::optional<LatchedSample> next_sample(double wait_s) { return samples_->next(wait_s); }
  const StreamGreeting& stream_facts() const { return samples_->greeting(); }
  // One line for the operator: e-stop, power, homed axes, limits, faults, the controller's messages.
  std::string status_words();

 private:
  void require_ready() const;
  void switch_on();
  void follow_homing();
  // A motion under the watch that it sets: released when it is done; ended, whatever it is, by any exception.
  void move_watched(const std::function<void()>& motion);
  void require_within_limits(std::span<const AxisPositions> way) const;
  struct Motion {
    std::string program;
    double longest_s = 0.0;
    // A move is alive as long as the positions change, also where the sensor has nothing to say.
    bool needs_readings = true;
  };
  // Runs a program to its end. `use` sees every sample and returns false to stop early; `done` says when the
  // samples have told all that was wanted. Every way out but the end of the program stops the machine.
  void run_program(const Motion& motion, const std::function<bool(const LatchedSample&)>& use,
                   const std::function<bool()>& done);
  void follow_program(const Motion& motion, const std::function<bool(const LatchedSample&)>& use,
                      const std::function<bool()>& done);
  void set_mode(const std::string& mode);
  void require_set(const std::string& command);
  bool is_homed();
  // `unexplained`: the kind of the fault where the controller gives no reason.
  [[noreturn]] void fail_with_reason(const std::string& what,
                                     MachineFault::Kind unexplained = MachineFault::Kind::interrupted);
  bool must_stop() const;
  void end_motion() noexcept;
  bool stands_still();

  LinuxCncSettings settings_;
  AxisLimits travel_;
  AxisDynamics dynamics_;
  std::unique_ptr<RshClient> commands_;
  std::unique_ptr<SampleStream> samples_;
  std::string mode_;
  // Whoever asks for the position may find that nobody answers.
  mutable std::atomic<MachineState> state_{MachineState::disconnected};
  std::atomic<bool> stop_asked_{false};
  std::function<bool()> stop_when_;
  std::uint64_t line_ = 0, point_ = 0;  // running numbers
};

}  // namespace trueblade
