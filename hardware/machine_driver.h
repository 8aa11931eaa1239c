// The seam between the program and a machine. The program measures only through this interface; whether a
// simulation, a LinuxCNC controller or a recorded scan stands behind it is known to nothing but `apps`.
//
// Axes: three linear stages x, y, z (mm) carry the probe, a rotary stage turns the part by theta (rad).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>

namespace trueblade {

struct AxisPositions {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double z_mm = 0.0;
  double theta_rad = 0.0;
};

// Why a sample carries no usable distance, or is doubtful. Several may hold.
struct ProbeFlags {
  bool out_of_range : 1 = false;  // the surface lies outside the lens's working range
  bool low_signal : 1 = false;    // SNR below the sensor's own threshold
  bool missed : 1 = false;        // no return at all

  std::uint8_t bits() const;
  static ProbeFlags from_bits(std::uint8_t bits);
  bool usable() const { return !out_of_range && !missed; }
};

// The driver's record: one probe sample with the axis positions at which it was taken, as the encoders report
// them.
struct ProbeSample {
  AxisPositions axes;
  double distance_mm = 0.0;  // along the beam from the probe origin; meaningful when flags.usable()
  double snr = 0.0;          // 0 to 1
  double time_s = 0.0;       // since connect
  ProbeFlags flags;
};

struct AxisLimits {
  AxisPositions lower;
  AxisPositions upper;
  bool contains(const AxisPositions& axes) const;
  void validate() const;  // throws InputError naming the axis: lower below upper, finite
};

enum class MachineState { disconnected, not_homed, idle, moving, stopped, faulted, unknown };
std::string to_string(MachineState state);

// A fault of the machine: the command ends with exit code 3. The message carries the controller's own words.
class MachineFault : public std::runtime_error {
 public:
  enum class Kind {
    connection,
    not_homed,
    limit,
    emergency_stop,
    following_error,
    sensor,
    protocol,
    storage,  // the journal cannot be written
    interrupted
  };
  MachineFault(Kind kind, const std::string& message);
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

// What of a scan was measured before, by an earlier run of the program: it is not measured again.
struct MeasuredBefore {
  double theta_rad;     // rotary angle of the view
  std::size_t lines;    // finished lines
  std::size_t samples;  // of these and of the line that was broken off
  // Positions of that line that were measured: a simulated machine goes on as if it had just passed them.
  std::span<const AxisPositions> of_line{};
};

// Receives the samples of a line as they arrive; returning false stops the scan after the sample.
using SampleSink = std::function<bool(const ProbeSample&)>;

class MachineDriver {
 public:
  virtual ~MachineDriver() = default;

  virtual void connect() = 0;
  virtual void home() = 0;  // precondition: connected
  virtual void move_to(
      const AxisPositions& target) = 0;  // precondition: homed and within limits; throws MachineFault
  // Through all positions in turn, the straight way from each to the next; the same preconditions.
  virtual void move_through(std::span<const AxisPositions> way);
  virtual ProbeSample measure_point() = 0;  // at the present position
  // Moves along `path` and takes one sample at each position. Returns the number of samples delivered.
  virtual std::size_t scan_line(std::span<const AxisPositions> path, const SampleSink& sink) = 0;
  // Advances the machine's running numbers of views, lines and samples as if `before` had been measured now.
  virtual void skip_measured(const MeasuredBefore& before) = 0;
  virtual void stop() noexcept = 0;  // ends motion at once; safe at any time, from any thread
  virtual MachineState state() const = 0;
  virtual AxisPositions position() const = 0;  // present one, by the encoders; precondition: connected
  virtual AxisLimits limits() const = 0;
};

}  // namespace trueblade
