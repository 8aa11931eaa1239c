// How long motion takes: speeds and accelerations of the axes. Plans are estimated with it, and the simulated
// machine keeps its clock by it.
#pragma once

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

// From one sample of a line to the next in continuous motion: the sensor's rate or the slowest axis decides.
double sample_interval_s(const AxisDynamics& dynamics, const Lens& lens, const AxisPositions& from,
                         const AxisPositions& to);

// The whole plan, starting at `start`.
double estimated_time_s(const ScanPlan& plan, const AxisDynamics& dynamics, const Lens& lens,
                        const AxisPositions& start);

}  // namespace trueblade
