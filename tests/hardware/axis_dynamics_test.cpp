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

TEST(AxisDynamics, SamplesComeAtTheSensorsRateOrAtTheAxesSpeed) {
  const Lens lens = standard_lens("25mm");  // 1 kHz
  EXPECT_DOUBLE_EQ(sample_interval_s(dynamics(), lens, {}, {0.001, 0.0, 0.0, 0.0}), 0.001);
  EXPECT_DOUBLE_EQ(sample_interval_s(dynamics(), lens, {}, {0.5, 0.5, 0.0, 0.0}), 0.05);
}

TEST(AxisDynamics, APlanTakesItsMovesAndItsSamples) {
  ScanPlan plan;
  plan.lines.resize(3);
  plan.lines[0].path = {{30.0, 0, 0, 0}, {30.5, 0, 0, 0}, {31.0, 0, 0, 0}};
  plan.lines[2].path = {{1.0, 0, 0, 0}};
  const double expected_s = 3.1 + 2 * 0.05 + 3.1;
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
