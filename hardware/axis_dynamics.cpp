#include "hardware/axis_dynamics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

// The way from one position of a line to the next. The pace is the share of full pace at which it is passed:
// at pace 1 it takes full_pace_s.
struct Way {
  double full_pace_s = 0.0;
  std::array<double, 4> speed{};        // signed, of each axis at full pace
  double most_pace_change_per_s = 0.0;  // by the acceleration of the axes; 0: nothing travels
};

class PaceOfLine {
 public:
  PaceOfLine(const AxisDynamics& dynamics, const Lens& lens)
      : reading_s_(1.0 / lens.rate_hz), acceleration_(as_array(dynamics.max_acceleration)) {
    const auto max_speed = as_array(dynamics.max_speed);
    for (std::size_t k = 0; k < 4; ++k) {
      s_per_travel_[k] = 1.0 / max_speed[k];
      per_acceleration_[k] = 1.0 / acceleration_[k];
    }
  }

  Way way(const AxisPositions& from, const AxisPositions& to) const {
    const std::array<double, 4> travel{to.x_mm - from.x_mm, to.y_mm - from.y_mm, to.z_mm - from.z_mm,
                                       to.theta_rad - from.theta_rad};
    Way way;
    way.full_pace_s = reading_s_;
    double most_s2 = 0.0;  // travel per acceleration, of the axis for which it is most
    for (std::size_t k = 0; k < 4; ++k) {
      way.full_pace_s = std::max(way.full_pace_s, std::abs(travel[k]) * s_per_travel_[k]);
      most_s2 = std::max(most_s2, std::abs(travel[k]) * per_acceleration_[k]);
    }
    const double per_s = 1.0 / way.full_pace_s;
    for (std::size_t k = 0; k < 4; ++k) way.speed[k] = travel[k] * per_s;
    if (most_s2 > 0.0) way.most_pace_change_per_s = way.full_pace_s / most_s2;
    return way;
  }

  // The square of the most pace at which the machine may go from one way over to the next.
  double most_at_bend(const Way& before, const Way& after) const {
    if (before.most_pace_change_per_s == 0.0 || after.most_pace_change_per_s == 0.0) return 0.0;
    const double spread_s = 0.5 * (before.full_pace_s + after.full_pace_s);  // at full pace
    double square = 1.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double change = std::abs(after.speed[k] - before.speed[k]);
      // The speed changes by pace * change within spread_s / pace.
      if (square * change > acceleration_[k] * spread_s) square = acceleration_[k] * spread_s / change;
    }
    return square;
  }

 private:
  double reading_s_;
  std::array<double, 4> acceleration_, s_per_travel_{}, per_acceleration_{};
};

// What a way adds to the square of the pace when it is all a ramp.
double square_gained(const Way& way) {
  return 2.0 * way.most_pace_change_per_s * way.full_pace_s;
}

// Speeding up from the pace at its start, going on at full pace where there is room, slowing down to that at
// its end.
double time_of_way_s(const Way& way, double pace_at_start, double pace_at_end) {
  if (way.most_pace_change_per_s == 0.0 || (pace_at_start == 1.0 && pace_at_end == 1.0))
    return way.full_pace_s;
  const double ends = 0.5 * (pace_at_start * pace_at_start + pace_at_end * pace_at_end);
  const double peak = std::min(1.0, std::sqrt(ends + 0.5 * square_gained(way)));
  const double in_ramps = (peak * peak - ends) / way.most_pace_change_per_s;
  return (2.0 * peak - pace_at_start - pace_at_end) / way.most_pace_change_per_s +
         std::max(0.0, way.full_pace_s - in_ramps) / peak;
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

std::vector<PassedPosition> line_motion(const AxisDynamics& dynamics, const Lens& lens,
                                        const AxisPositions& from, std::span<const AxisPositions> path) {
  const PaceOfLine pace_of(dynamics, lens);
  std::vector<Way> ways;
  ways.reserve(path.size());
  for (std::size_t k = 0; k < path.size(); ++k)
    ways.push_back(pace_of.way(k == 0 ? from : path[k - 1], path[k]));

  // pace[k]: at the start of way k; its square first. Forwards no faster than bends and ramps allow, then
  // backwards.
  std::vector<double> pace(path.size() + 1, 0.0);
  for (std::size_t k = 1; k < path.size(); ++k)
    pace[k] = std::min(pace_of.most_at_bend(ways[k - 1], ways[k]), pace[k - 1] + square_gained(ways[k - 1]));
  for (std::size_t k = path.size(); k-- > 1;)
    pace[k] = std::min(pace[k], pace[k + 1] + square_gained(ways[k]));
  for (double& of_way : pace)
    if (of_way < 1.0) of_way = std::sqrt(of_way);

  std::vector<PassedPosition> passed;
  passed.reserve(path.size());
  double time_s = 0.0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    time_s += time_of_way_s(ways[k], pace[k], pace[k + 1]);
    // Halfway round the bend.
    const std::array<double, 4>& before = ways[k].speed;
    const std::array<double, 4>& after = ways[std::min(k + 1, path.size() - 1)].speed;
    const auto velocity = [&](std::size_t axis) { return pace[k + 1] * 0.5 * (before[axis] + after[axis]); };
    passed.push_back({time_s, {velocity(0), velocity(1), velocity(2), velocity(3)}});
  }
  return passed;
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
    time_s += line_motion(dynamics, lens, line.path.front(), line.path).back().time_s;
    at = line.path.back();
  }
  for (const AxisPositions& by : plan.retreat) {
    time_s += move_time_s(dynamics, at, by);
    at = by;
  }
  return time_s;
}

}  // namespace trueblade
