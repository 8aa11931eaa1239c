// Kinematics: closed forms for the axes one by one, the round trip sample -> point -> axes, validation.
#include "hardware/machine_geometry.h"

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/error.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;

ProbeSample sample_at(double x_mm, double y_mm, double z_mm, double theta_rad, double distance_mm) {
  ProbeSample sample;
  sample.axes = {x_mm, y_mm, z_mm, theta_rad};
  sample.distance_mm = distance_mm;
  return sample;
}

TEST(MachineGeometry, AtZeroAngleThePointIsProbeOriginPlusDistanceAlongTheBeam) {
  MachineGeometry geometry;
  geometry.stage_from_probe_at_zero.translation_mm = {1.0, 200.0, 3.0};
  const Vec3 point = point_in_mcs_mm(geometry, sample_at(10.0, 20.0, 30.0, 0.0, 25.0));
  // Rounding of four additions of numbers below 256: 4 * 2^-53 * 256.
  EXPECT_LT((point - Vec3(11.0, 195.0, 33.0)).norm(), 2e-13);
}

TEST(MachineGeometry, TurningThePartByAQuarterTurnsTheMeasuredPointBack) {
  // The part turns by +90 deg about z: what now stands at stage (0, 10, 0) stood at (10, 0, 0) before.
  const MachineGeometry geometry;
  const Vec3 point = point_in_mcs_mm(geometry, sample_at(0.0, 35.0, 0.0, 0.5 * kPi, 25.0));
  EXPECT_LT((point - Vec3(10.0, 0.0, 0.0)).norm(), 1e-14 * 35.0);  // sine and cosine to 2 ulp
}

TEST(MachineGeometry, TheRotaryAxisDoesNotMove) {
  MachineGeometry geometry;
  geometry.rotary_axis_point_mm = {5.0, -3.0, 2.0};
  geometry.rotary_axis_direction = Vec3(1.0, 2.0, 2.0) / 3.0;
  for (const double theta : {-2.0, 0.3, 3.0}) {
    const Vec3 on_axis = geometry.rotary_axis_point_mm + 7.0 * geometry.rotary_axis_direction;
    EXPECT_LT((stage_from_mcs(geometry, theta) * on_axis - on_axis).norm(), 1e-14);
  }
}

TEST(MachineGeometry, MeasuredPointsAndAxesInvertEachOtherForAnyMachine) {
  Rng rng(1, 0, "round trip");
  for (int k = 0; k < 200; ++k) {
    MachineGeometry geometry;
    for (Vec3& direction : geometry.axis_direction)
      direction = (direction + 0.2 * rng.normal_vector().cwiseMax(-2.0).cwiseMin(2.0)).normalized();
    geometry.stage_from_probe_at_zero.rotation = rotation_from_vector(rng.normal_vector());
    geometry.stage_from_probe_at_zero.translation_mm = 50.0 * rng.normal_vector();
    geometry.beam_direction = rng.normal_vector().normalized();
    geometry.rotary_axis_direction = rng.normal_vector().normalized();
    geometry.rotary_axis_point_mm = 20.0 * rng.normal_vector();
    const double distance_mm = 25.0;
    const Vec3 wanted = 40.0 * rng.normal_vector();
    const double theta = 6.0 * (rng.uniform() - 0.5);

    const Vec3 beam_mcs = beam_in_mcs(geometry, {0.0, 0.0, 0.0, theta}).direction;
    ProbeSample sample;
    sample.axes = axes_for_probe_origin(geometry, wanted - distance_mm * beam_mcs, theta);
    sample.distance_mm = distance_mm;
    // Coordinates up to 500 mm, axes skewed by up to a condition number of 10, some 20 operations:
    // 500 mm * 1.1e-16 * 10 * 20.
    EXPECT_LT((point_in_mcs_mm(geometry, sample) - wanted).norm(), 1e-11);

    const AxisPositions again =
        axes_for_probe_origin(geometry, beam_in_mcs(geometry, sample.axes).origin_mm, theta);
    EXPECT_NEAR(again.x_mm, sample.axes.x_mm, 1e-11);
    EXPECT_NEAR(again.y_mm, sample.axes.y_mm, 1e-11);
    EXPECT_NEAR(again.z_mm, sample.axes.z_mm, 1e-11);
  }
}

TEST(MachineGeometry, ImpossibleMachinesAreRefusedByName) {
  const auto message_of = [](const MachineGeometry& geometry) -> std::string {
    try {
      geometry.validate();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message_of({}), "");
  MachineGeometry long_beam;
  long_beam.beam_direction = {0.0, -2.0, 0.0};
  EXPECT_NE(message_of(long_beam).find("beam_direction"), std::string::npos);
  MachineGeometry flat;
  flat.axis_direction[2] = Vec3::UnitX();
  EXPECT_NE(message_of(flat).find("independent"), std::string::npos);
  MachineGeometry twice;
  twice.linear_axis_order = {LinearAxis::x, LinearAxis::x, LinearAxis::z};
  EXPECT_NE(message_of(twice).find("linear_axis_order"), std::string::npos);
  MachineGeometry nowhere;
  nowhere.rotary_axis_point_mm.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message_of(nowhere).find("rotary_axis_point_mm"), std::string::npos);
}

}  // namespace
}  // namespace trueblade
