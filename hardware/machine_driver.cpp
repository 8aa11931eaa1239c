#include "hardware/machine_driver.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace trueblade {
namespace {

constexpr std::uint8_t kOutOfRangeBit = 1;
constexpr std::uint8_t kLowSignalBit = 2;
constexpr std::uint8_t kMissedBit = 4;

}  // namespace

std::uint8_t ProbeFlags::bits() const {
  return static_cast<std::uint8_t>((out_of_range ? kOutOfRangeBit : 0) | (low_signal ? kLowSignalBit : 0) |
                                   (missed ? kMissedBit : 0));
}

ProbeFlags ProbeFlags::from_bits(std::uint8_t bits) {
  ProbeFlags flags;
  flags.out_of_range = (bits & kOutOfRangeBit) != 0;
  flags.low_signal = (bits & kLowSignalBit) != 0;
  flags.missed = (bits & kMissedBit) != 0;
  return flags;
}

void AxisLimits::validate() const {
  const auto require = [](const char* axis, double low, double high, const char* unit) {
    if (!(low < high && std::isfinite(low) && std::isfinite(high)))
      throw InputError(
          fmt::format("travel of {}: from {} to {} {}, must be finite and upward", axis, low, high, unit));
  };
  constexpr double kDegree = std::numbers::pi / 180.0;
  require("x", lower.x_mm, upper.x_mm, "mm");
  require("y", lower.y_mm, upper.y_mm, "mm");
  require("z", lower.z_mm, upper.z_mm, "mm");
  require("theta", lower.theta_rad / kDegree, upper.theta_rad / kDegree, "deg");
}

bool AxisLimits::contains(const AxisPositions& axes) const {
  // Written so that NaN is outside.
  const auto within = [](double low, double value, double high) { return low <= value && value <= high; };
  return within(lower.x_mm, axes.x_mm, upper.x_mm) && within(lower.y_mm, axes.y_mm, upper.y_mm) &&
         within(lower.z_mm, axes.z_mm, upper.z_mm) &&
         within(lower.theta_rad, axes.theta_rad, upper.theta_rad);
}

std::string to_string(MachineState state) {
  switch (state) {
    case MachineState::disconnected:
      return "disconnected";
    case MachineState::not_homed:
      return "not homed";
    case MachineState::idle:
      return "idle";
    case MachineState::moving:
      return "moving";
    case MachineState::stopped:
      return "stopped";
    case MachineState::faulted:
      return "faulted";
    case MachineState::unknown:
      return "unknown";
  }
  return "unknown";
}

void MachineDriver::move_through(std::span<const AxisPositions> way) {
  for (const AxisPositions& at : way) move_to(at);
}

MachineFault::MachineFault(Kind kind, const std::string& message)
    : std::runtime_error(message), kind_(kind) {}

}  // namespace trueblade
