// How long motion takes: speeds and accelerations of the axes. Plans are estimated with it, and the simulated
// machine keeps its clock by it.
#pragma once

#include <span>
#include <vector>

#include "hardware/lens.h"
#include "hardware/machine_driver.h"
#include "hardware/scan_plan.h"

namespace trueblade {

struct AxisDynamics {
  AxisPositions max_speed{50.0, 50.0, 50.0, 0.5};            // mm/s, rad/s
  AxisPositions max_acceleration{500.0, 500.0, 500.0, 2.0};  // mm/s^2, rad/s^2

  void validate() const;  // throws InputError naming the axis, value and constraint
};

// From standstill to standstill, all axes starting together: the slowest axis decides, each with a
// trapezoidal (or, when short, triangular) speed profile.
double move_time_s(const AxisDynamics& dynamics, const AxisPositions& from, const AxisPositions& to);

// Of a position on a line: when it is passed, and how fast.
struct PassedPosition {
  double time_s;  // after the start of the line
  AxisPositions velocity_per_s;
};

// The positions of a line in one continuous motion, from standstill at `from` to standstill at the last
// position; samples are triggered by position. On the way from one position to the next the sensor's rate or
// the slowest axis sets the pace; start, end and changes of pace are ramps, and bends are passed so slowly
// that the change of an axis's speed, spread over the halves of both ways, keeps within its acceleration. A
// position that is not travelled to (the first, where the machine stands on it) is measured standing, for one
// interval of the sensor.
std::vector<PassedPosition> line_motion(const AxisDynamics& dynamics, const Lens& lens,
                                        const AxisPositions& from, std::span<const AxisPositions> path);

// The whole plan, starting at `start`.
double estimated_time_s(const ScanPlan& plan, const AxisDynamics& dynamics, const Lens& lens,
                        const AxisPositions& start);

}  // namespace trueblade
