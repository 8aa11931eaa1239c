// The virtual machine's probe on its own: fired from axis positions that a real controller latched. With the
// same set-up, seed and numbers of view, line and point it draws what the simulated machine draws.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/simulated_machine.h"

namespace trueblade {

class LatchedProbe {
 public:
  // Throws InputError when the set-up is not valid.
  LatchedProbe(VirtualPart part, VirtualSetup setup);

  struct Trigger {
    AxisPositions axes;
    double time_s = 0.0;
    // Running number of the first point of the line that is being measured; absent: nothing is, and the
    // reading has draws of its own.
    std::optional<std::uint64_t> first_point;
    std::uint64_t line = 0;
    // Of the line, that the machine is heading for; absent: it stands at the line's start or end.
    std::optional<std::uint64_t> position;
  };
  // Call in the order of the triggers. A view begins when a line is measured at another rotary angle than the
  // last one; the very first line begins the numbering of the views anew.
  ProbeSample measure(const Trigger& trigger);

 private:
  void begin_line(const Trigger& trigger);

  VirtualPart part_;
  VirtualSetup setup_;
  TrueMachine true_machine_;
  Rng sensor_stream_;
  std::optional<Trigger> last_;
  std::optional<std::uint64_t> first_point_;  // of the present line
  std::uint64_t position_ = 0, view_ = 0, free_readings_ = 0;
  double view_theta_rad_ = 0.0;
};

}  // namespace trueblade
