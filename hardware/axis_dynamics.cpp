#include "hardware/axis_dynamics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

std::array<double, 4> as_array(const AxisPositions& axes) {
  return {axes.x_mm, axes.y_mm, axes.z_mm, axes.theta_rad};
}

std::array<double, 4> travel_between(const AxisPositions& from, const AxisPositions& to) {
  return {std::abs(to.x_mm - from.x_mm), std::abs(to.y_mm - from.y_mm), std::abs(to.z_mm - from.z_mm),
          std::abs(to.theta_rad - from.theta_rad)};
}

double trapezoid_time_s(double travel, double speed, double acceleration) {
  const double full_speed_travel = speed * speed / acceleration;  // speeding up and slowing down
  return travel >= full_speed_travel ? travel / speed + speed / acceleration
                                     : 2.0 * std::sqrt(travel / acceleration);
}

}  // namespace

void AxisDynamics::validate() const {
  static constexpr std::array<const char*, 4> kAxis{"x", "y", "z", "theta"};
  const auto speed = as_array(max_speed);
  const auto acceleration = as_array(max_acceleration);
  for (std::size_t k = 0; k < 4; ++k) {
    if (!(speed[k] > 0.0 && std::isfinite(speed[k])))
      throw InputError(fmt::format("max_speed {} is {}, must be above 0", kAxis[k], speed[k]));
    if (!(acceleration[k] > 0.0 && std::isfinite(acceleration[k])))
      throw InputError(fmt::format("max_acceleration {} is {}, must be above 0", kAxis[k], acceleration[k]));
  }
}

double move_time_s(const AxisDynamics& dynamics, const AxisPositions& from, const AxisPositions& to) {
  const auto travel = travel_between(from, to);
  const auto speed = as_array(dynamics.max_speed);
  const auto acceleration = as_array(dynamics.max_acceleration);
  double slowest_s = 0.0;
  for (std::size_t k = 0; k < 4; ++k)
    slowest_s = std::max(slowest_s, trapezoid_time_s(travel[k], speed[k], acceleration[k]));
  return slowest_s;
}

double sample_interval_s(const AxisDynamics& dynamics, const Lens& lens, const AxisPositions& from,
                         const AxisPositions& to) {
  const auto travel = travel_between(from, to);
  const auto speed = as_array(dynamics.max_speed);
  double interval_s = 1.0 / lens.rate_hz;
  for (std::size_t k = 0; k < 4; ++k) interval_s = std::max(interval_s, travel[k] / speed[k]);
  return interval_s;
}

double estimated_time_s(const ScanPlan& plan, const AxisDynamics& dynamics, const Lens& lens,
                        const AxisPositions& start) {
  AxisPositions at = start;
  double time_s = 0.0;
  for (const PlannedLine& line : plan.lines) {
    if (line.path.empty()) continue;
    for (const AxisPositions& by : line.approach) {
      time_s += move_time_s(dynamics, at, by);
      at = by;
    }
    time_s += move_time_s(dynamics, at, line.path.front());
    for (std::size_t k = 1; k < line.path.size(); ++k)
      time_s += sample_interval_s(dynamics, lens, line.path[k - 1], line.path[k]);
    at = line.path.back();
  }
  for (const AxisPositions& by : plan.retreat) {
    time_s += move_time_s(dynamics, at, by);
    at = by;
  }
  return time_s;
}

}  // namespace trueblade
