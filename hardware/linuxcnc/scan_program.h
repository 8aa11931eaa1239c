// Motion as programs (G code) for the controller.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hardware/machine_driver.h"

namespace trueblade {

// Through all positions in turn, stopping at each, as fast as the axes can.
std::string move_program(std::span<const AxisPositions> way);

struct ScanPace {
  double servo_period_s;
  double max_speed_mm_per_s;  // of the linear axes together
};

// The line of the program that moves to the first position of a path; each further position has the next
// line. The controller's pin motion.program-line tells by it which position it is heading for.
inline constexpr std::int32_t kFirstPointLine = 5;
// How far continuous motion may cut a corner between positions (G64 P).
inline constexpr double kPathToleranceMm = 0.005;

// Along `path` in continuous motion, slow enough that every position is passed in at least two servo periods.
// Analog output 0 of the controller carries `first_point` during the path and -1 afterwards, output 1 carries
// `line`: the running numbers of the first position and of the line.
std::string scan_program(std::span<const AxisPositions> path, std::uint64_t first_point, std::uint64_t line,
                         const ScanPace& pace);

// Stands for a moment and measures as point number `point`.
std::string point_program(std::uint64_t point);

}  // namespace trueblade
