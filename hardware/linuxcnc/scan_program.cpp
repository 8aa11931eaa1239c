#include "hardware/linuxcnc/scan_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace trueblade {
namespace {

// mm, absolute, feed per minute, XY plane, no cutter or tool length compensation.
constexpr const char* kModes = "G21 G90 G94 G17 G40 G49";
// Machine coordinates (G53): no work offset that someone left set can move the probe. 1e-7 mm and degree.
std::string position_words(const AxisPositions& at) {
  return fmt::format("X{:.7f} Y{:.7f} Z{:.7f} C{:.7f}", at.x_mm, at.y_mm, at.z_mm,
                     at.theta_rad * 180.0 / std::numbers::pi);
}

double travel_mm(const AxisPositions& from, const AxisPositions& to) {
  return std::hypot(to.x_mm - from.x_mm, to.y_mm - from.y_mm, to.z_mm - from.z_mm);
}

}  // namespace

std::string move_program(std::span<const AxisPositions> way) {
  std::string program = fmt::format("{} G61.1\nM68 E0 Q-1\n", kModes);
  for (const AxisPositions& at : way) program += fmt::format("G53 G0 {}\n", position_words(at));
  return program + "M2\n";
}

std::string scan_program(std::span<const AxisPositions> path, std::uint64_t first_point, std::uint64_t line,
                         const ScanPace& pace) {
  // Q0: the controller may not drop positions that lie on a straight line.
  std::string program = fmt::format("{} G64 P{} Q0\nM68 E1 Q{}\nM68 E0 Q{}\nG4 P0.02\n", kModes,
                                    kPathToleranceMm, line, first_point);
  auto out = std::back_inserter(program);
  for (std::size_t k = 0; k < path.size(); ++k) {
    const double travel = k == 0 ? 0.0 : travel_mm(path[k - 1], path[k]);
    const double slow_mm_per_s = travel / (2.0 * pace.servo_period_s);
    const double speed =
        travel > 0.0 ? std::min(pace.max_speed_mm_per_s, slow_mm_per_s) : pace.max_speed_mm_per_s;
    fmt::format_to(out, "G53 G1 {} F{:.6f}\n", position_words(path[k]), 60.0 * speed);
  }
  return program + "M68 E0 Q-1\nM2\n";
}

std::string point_program(std::uint64_t point) {
  return fmt::format("{} G61.1\nM68 E0 Q{}\nG4 P0.02\nM68 E0 Q-1\nM2\n", kModes, point);
}

}  // namespace trueblade
