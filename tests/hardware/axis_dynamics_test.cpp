// Motion times in closed form: trapezoidal and triangular profiles, the slowest axis, sampling rate.
#include "hardware/axis_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

AxisDynamics dynamics() {
  AxisDynamics d;
  d.max_speed = {10.0, 20.0, 40.0, 1.0};
  d.max_acceleration = {100.0, 100.0, 100.0, 2.0};
  return d;
}

TEST(AxisDynamics, LongMovesAreTrapezoids) {
  // 30 mm at 10 mm/s and 100 mm/s^2: 0.1 s to speed, 0.1 s to rest, together 1 mm; 29 mm at speed.
  EXPECT_NEAR(move_time_s(dynamics(), {}, {30.0, 0.0, 0.0, 0.0}), 0.2 + 2.9, 1e-12);
}

TEST(AxisDynamics, ShortMovesAreTriangles) {
  // 0.25 mm at 100 mm/s^2: half the way in sqrt(2 * 0.125 / 100) = 0.05 s.
  EXPECT_NEAR(move_time_s(dynamics(), {}, {0.25, 0.0, 0.0, 0.0}), 0.1, 1e-12);
}

TEST(AxisDynamics, TheSlowestAxisDecidesAndDirectionDoesNot) {
  const AxisPositions target{-30.0, 30.0, 30.0, 0.1};
  EXPECT_DOUBLE_EQ(move_time_s(dynamics(), {}, target), move_time_s(dynamics(), {}, {30.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(move_time_s(dynamics(), target, target), 0.0);
}

// `count` positions `step` apart, the first one step from the start.
std::vector<AxisPositions> straight(std::size_t count, const AxisPositions& step) {
  std::vector<AxisPositions> path;
  for (std::size_t k = 1; k <= count; ++k) {
    const auto n = static_cast<double>(k);
    path.push_back({n * step.x_mm, n * step.y_mm, n * step.z_mm, n * step.theta_rad});
  }
  return path;
}

// 30 mm in steps of 0.5 mm: the trapezoid of the move over the whole way, whatever the steps; the speed by
// the way from the nearer end.
TEST(AxisDynamics, ALineIsOneTrapezoid) {
  const auto path = straight(60, {0.5, 0.0, 0.0, 0.0});
  const auto motion = line_motion(dynamics(), standard_lens("25mm"), {}, path);
  ASSERT_EQ(motion.size(), 60u);
  EXPECT_NEAR(motion.back().time_s, move_time_s(dynamics(), {}, path.back()), 1e-12);
  for (std::size_t k = 0; k < 60; ++k) {
    const double travel_mm = path[k].x_mm;
    const double speed = std::min(10.0, std::sqrt(2.0 * 100.0 * std::min(travel_mm, 30.0 - travel_mm)));
    EXPECT_NEAR(motion[k].velocity_per_s.x_mm, speed, 1e-9);
    // Ramps of 0.5 mm in 0.1 s at both ends.
    const double expected_s = k < 59 ? 0.1 + (travel_mm - 0.5) / 10.0 : 3.1;
    EXPECT_NEAR(motion[k].time_s, expected_s, 1e-12);
  }
}

// 0.4 mm in steps of 0.1: never at full speed; after half the way sqrt(2 * 0.2 / 100) s.
TEST(AxisDynamics, AShortLineIsATriangle) {
  const auto motion = line_motion(dynamics(), standard_lens("25mm"), {}, straight(4, {0.1, 0.0, 0.0, 0.0}));
  EXPECT_NEAR(motion[1].time_s, std::sqrt(0.004), 1e-12);
  EXPECT_NEAR(motion[1].velocity_per_s.x_mm, 100.0 * std::sqrt(0.004), 1e-9);
  EXPECT_NEAR(motion[3].time_s, 2.0 * std::sqrt(0.004), 1e-12);
  EXPECT_EQ(motion[3].velocity_per_s.x_mm, 0.0);
}

// Steps of 2 um at the sensor's 1 kHz: 2 mm/s, reached within 20 um and 0.02 s.
TEST(AxisDynamics, TheSensorsRateSetsThePaceOfDenseLines) {
  const auto motion =
      line_motion(dynamics(), standard_lens("25mm"), {}, straight(1000, {0.002, 0.0, 0.0, 0.0}));
  EXPECT_NEAR(motion.back().time_s, 1.0 + 0.02, 1e-12);
  EXPECT_NEAR(motion[500].velocity_per_s.x_mm, 2.0, 1e-9);
  EXPECT_NEAR(motion[501].time_s - motion[500].time_s, 0.001, 1e-12);
}

TEST(AxisDynamics, AMachineThatStandsOnAPositionMeasuresItStanding) {
  const std::vector<AxisPositions> path{{1, 0, 0, 0}, {1, 0, 0, 0}, {1.1, 0, 0, 0}, {1.2, 0, 0, 0}};
  const auto motion = line_motion(dynamics(), standard_lens("25mm"), path[0], path);
  EXPECT_NEAR(motion[0].time_s, 0.001, 1e-15);
  EXPECT_NEAR(motion[1].time_s, 0.002, 1e-15);
  EXPECT_EQ(motion[1].velocity_per_s.x_mm, 0.0);
  EXPECT_NEAR(motion[3].time_s, 0.002 + 2.0 * std::sqrt(0.2 / 100.0), 1e-12);
}

// x goes on while z turns from +s to -s: its speed must change by twice as much within the time of one step.
TEST(AxisDynamics, BendsArePassedWithinTheAcceleration) {
  constexpr double kStep = 0.2;  // mm of x, at full pace 0.02 s
  for (const double slope : {0.02, 0.2}) {
    std::vector<AxisPositions> path;
    for (int k = 1; k <= 40; ++k)
      path.push_back({k * kStep, 0.0, slope * kStep * (k <= 20 ? k : 40 - k), 0.0});
    const auto motion = line_motion(dynamics(), standard_lens("25mm"), {}, path);
    // pace * 2 slope 10 mm/s within 0.02 s / pace, at 100 mm/s^2.
    const double pace = std::min(1.0, std::sqrt(100.0 * 0.02 / (2.0 * slope * 10.0)));
    EXPECT_NEAR(motion[19].velocity_per_s.x_mm, 10.0 * pace, 1e-9);
    EXPECT_NEAR(motion[19].velocity_per_s.z_mm, 0.0, 1e-12);
    // From full speed to the bend and back at 100 mm/s^2 costs (10 - v)^2 / (100 * 10) s more than going on.
    const double slowing_s = std::pow(10.0 * (1.0 - pace), 2) / (100.0 * 10.0);
    EXPECT_NEAR(motion.back().time_s, 8.0 / 10.0 + 0.1 + slowing_s, 1e-9);
  }
}

TEST(AxisDynamics, APlanTakesItsMovesAndItsLines) {
  ScanPlan plan;
  plan.lines.resize(3);
  plan.lines[0].path = {{30.0, 0, 0, 0}, {30.5, 0, 0, 0}, {31.0, 0, 0, 0}};
  plan.lines[2].path = {{1.0, 0, 0, 0}};
  // Moves of 30 mm, lines of 1 mm and of nothing, the first sample of each taken standing.
  const double expected_s = 3.1 + (0.001 + 0.2) + 3.1 + 0.001;
  EXPECT_NEAR(estimated_time_s(plan, dynamics(), standard_lens("25mm"), {}), expected_s, 1e-12);
}

TEST(AxisDynamics, ImpossibleValuesAreRefused) {
  AxisDynamics still = dynamics();
  still.max_speed.theta_rad = 0.0;
  EXPECT_THROW(still.validate(), InputError);
  AxisDynamics nan = dynamics();
  nan.max_acceleration.y_mm = std::nan("");
  EXPECT_THROW(nan.validate(), InputError);
}

}  // namespace
}  // namespace trueblade
