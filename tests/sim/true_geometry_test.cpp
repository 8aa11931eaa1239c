// The true chain: without errors it is the nominal one; each source alone moves the probe, the table or the
// part as its definition says.
#include "sim/true_geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/random.h"

namespace trueblade {
namespace {

using enum ErrorSource;

// A machine without symmetry, so that no error hides: skew axes, the mount off the origin, a tilted rotary
// axis away from it.
MachineGeometry oblique_machine() {
  MachineGeometry geometry;
  geometry.linear_axis_order = {LinearAxis::z, LinearAxis::x, LinearAxis::y};
  geometry.axis_direction[1] = Vec3(0.1, 1.0, -0.05).normalized();
  geometry.stage_from_probe_at_zero.rotation = rotation_from_vector({0.1, 0.2, -0.3});
  geometry.stage_from_probe_at_zero.translation_mm = {10.0, 120.0, -20.0};
  geometry.rotary_axis_point_mm = {3.0, -4.0, 5.0};
  geometry.rotary_axis_direction = Vec3(0.1, -0.1, 1.0).normalized();
  return geometry;
}

double difference(const RigidTransform& a, const RigidTransform& b) {
  // Of the images of three points 100 mm out: rotation and translation in one length.
  double worst = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 p = 100.0 * Vec3::Unit(k);
    worst = std::max(worst, (a * p - b * p).norm());
  }
  return worst;
}

TEST(TrueGeometry, WithoutErrorsItIsTheNominalGeometry) {
  const MachineGeometry geometry = oblique_machine();
  const ErrorValues none;
  Rng rng(1, 0, "axes");
  for (int k = 0; k < 50; ++k) {
    const AxisPositions axes{50.0 * rng.normal(), 50.0 * rng.normal(), 50.0 * rng.normal(), rng.normal()};
    // Some ten products of numbers below 500 mm: 10 * 500 * 1.1e-16.
    EXPECT_LT(difference(true_stage_from_probe(geometry, axes, none, 1e4), stage_from_probe(geometry, axes)),
              1e-12);
    EXPECT_LT(difference(true_stage_from_mcs(geometry, axes.theta_rad, none),
                         stage_from_mcs(geometry, axes.theta_rad)),
              1e-12);
    RigidTransform mcs_from_part, mcs_from_fixture;
    mcs_from_part.rotation = rotation_from_vector(rng.normal_vector());
    mcs_from_part.translation_mm = 100.0 * rng.normal_vector();
    mcs_from_fixture.rotation = rotation_from_vector(rng.normal_vector());
    mcs_from_fixture.translation_mm = 100.0 * rng.normal_vector();
    EXPECT_LT(difference(true_mcs_from_part(mcs_from_part, mcs_from_fixture, none), mcs_from_part), 1e-12);
  }
  EXPECT_LT((true_beam_direction(geometry, none) - geometry.beam_direction).norm(), 1e-15);
}

// Where the probe origin goes, in `stage`, for one source of the probe's chain.
Vec3 probe_shift_mm(const MachineGeometry& geometry, const AxisPositions& axes, ErrorSource source,
                    double value) {
  ErrorValues errors;
  errors[source] = value;
  return true_stage_from_probe(geometry, axes, errors, 0.0).translation_mm -
         stage_from_probe(geometry, axes).translation_mm;
}

TEST(TrueGeometry, PositioningAndStraightnessShiftTheProbeAlongTheAxes) {
  const MachineGeometry geometry = oblique_machine();
  const AxisPositions axes{11.0, 22.0, 33.0, 0.4};
  const std::array<std::array<ErrorSource, 3>, 3> sources{
      {{exx, eyx, ezx}, {exy, eyy, ezy}, {exz, eyz, ezz}}};
  for (const auto& of_axis : sources)
    for (std::size_t direction = 0; direction < 3; ++direction)
      EXPECT_LT((probe_shift_mm(geometry, axes, of_axis[direction], 0.01) -
                 0.01 * geometry.axis_direction[direction])
                    .norm(),
                1e-13);
}

TEST(TrueGeometry, AngularErrorsActWithTheLeverArmOfWhatTheAxisCarries) {
  const MachineGeometry geometry = oblique_machine();  // z carries x, x carries y, y the probe
  const AxisPositions axes{11.0, 22.0, 33.0, 0.4};
  const Vec3 mount = geometry.stage_from_probe_at_zero.translation_mm;
  const Vec3 beyond_y = mount;
  const Vec3 beyond_x = mount + axes.y_mm * geometry.axis_direction[1];
  const Vec3 beyond_z = beyond_x + axes.x_mm * geometry.axis_direction[0];
  const double angle = 1e-5;
  const struct {
    std::array<ErrorSource, 3> sources;
    Vec3 arm_mm;
  } cases[] = {{{eax, ebx, ecx}, beyond_x}, {{eay, eby, ecy}, beyond_y}, {{eaz, ebz, ecz}, beyond_z}};
  for (const auto& c : cases)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 expected = angle * geometry.axis_direction[k].cross(c.arm_mm);
      // Second order: angle^2 / 2 times an arm below 150 mm.
      EXPECT_LT((probe_shift_mm(geometry, axes, c.sources[k], angle) - expected).norm(), 7.5e-9);
      EXPECT_GT(expected.norm(), 7.5e-5);
    }
}

TEST(TrueGeometry, SquarenessTurnsTheTravelOfTheAxis) {
  const MachineGeometry geometry;
  const AxisPositions axes{10.0, 20.0, 30.0, 0.0};
  const double angle = 1e-5;
  const double second_order = 0.5 * angle * angle * 30.0;
  // y turned about +z leans towards -x, z about +y towards +x, z about +x towards -y.
  EXPECT_LT((probe_shift_mm(geometry, axes, c0y, angle) - Vec3(-20.0 * angle, 0, 0)).norm(), second_order);
  EXPECT_LT((probe_shift_mm(geometry, axes, b0z, angle) - Vec3(30.0 * angle, 0, 0)).norm(), second_order);
  EXPECT_LT((probe_shift_mm(geometry, axes, a0z, angle) - Vec3(0, -30.0 * angle, 0)).norm(), second_order);
}

TEST(TrueGeometry, TheProbeShiftsInItsOwnFrameAndDriftsInTheStage) {
  const MachineGeometry geometry = oblique_machine();
  EXPECT_LT((probe_shift_mm(geometry, {}, probe_y, 0.02) -
             geometry.stage_from_probe_at_zero.rotation * Vec3(0.0, 0.02, 0.0))
                .norm(),
            1e-13);
  ErrorValues errors;
  errors[drift_x] = 1e-6;
  const Vec3 drifted = true_stage_from_probe(geometry, {}, errors, 3600.0).translation_mm -
                       stage_from_probe(geometry, {}).translation_mm;
  EXPECT_LT((drifted - Vec3(0.0036, 0.0, 0.0)).norm(), 1e-13);
}

TEST(TrueGeometry, TheBeamTiltsByTheAngleAboutTwoNormals) {
  const MachineGeometry geometry = oblique_machine();
  ErrorValues a, b;
  a[beam_a] = 1e-3;
  b[beam_b] = 1e-3;
  const Vec3 tilt_a = true_beam_direction(geometry, a) - geometry.beam_direction;
  const Vec3 tilt_b = true_beam_direction(geometry, b) - geometry.beam_direction;
  // Chord of an angle: 2 sin(angle / 2). The two chords leave the plane of the normals by angle^2 / 2 each.
  EXPECT_NEAR(tilt_a.norm(), 2.0 * std::sin(0.5e-3), 1e-15);
  EXPECT_NEAR(tilt_b.norm(), 2.0 * std::sin(0.5e-3), 1e-15);
  EXPECT_NEAR(tilt_a.dot(tilt_b), 0.0, 0.26e-12);
}

TEST(TrueGeometry, RotaryErrorsMoveTheTableAsIso230Says) {
  MachineGeometry geometry;
  geometry.rotary_axis_point_mm = {5.0, 0.0, 0.0};
  const double theta = 0.8;
  const Vec3 on_table(25.0, 10.0, 40.0);
  const auto moved_by = [&](ErrorSource source, double value) -> Vec3 {
    ErrorValues errors;
    errors[source] = value;
    return true_stage_from_mcs(geometry, theta, errors) * on_table -
           stage_from_mcs(geometry, theta) * on_table;
  };
  const Vec3 in_stage = stage_from_mcs(geometry, theta) * on_table;
  const Vec3 arm = in_stage - geometry.rotary_axis_point_mm;
  const double angle = 1e-5;
  const double second_order = angle * angle * 50.0;
  EXPECT_LT((moved_by(exc, 0.01) - Vec3(0.01, 0, 0)).norm(), 1e-13);
  EXPECT_LT((moved_by(eyc, 0.01) - Vec3(0, 0.01, 0)).norm(), 1e-13);
  EXPECT_LT((moved_by(ezc, 0.01) - Vec3(0, 0, 0.01)).norm(), 1e-13);
  EXPECT_LT((moved_by(eac, angle) - angle * Vec3::UnitX().cross(arm)).norm(), second_order);
  EXPECT_LT((moved_by(ebc, angle) - angle * Vec3::UnitY().cross(arm)).norm(), second_order);
  EXPECT_LT((moved_by(ecc, angle) - angle * Vec3::UnitZ().cross(arm)).norm(), second_order);
  // A misplaced axis turns the table about another line: (I - R) times the misplacement.
  const Mat3 turn = Eigen::AngleAxisd(theta, Vec3::UnitZ()).toRotationMatrix();
  const Mat3 rest = Mat3::Identity() - turn;
  EXPECT_LT((moved_by(xoc, 0.01) - rest * Vec3(0.01, 0, 0)).norm(), 1e-13);
  EXPECT_LT((moved_by(yoc, 0.01) - rest * Vec3(0, 0.01, 0)).norm(), 1e-13);
  // A tilted axis L: L R inverse(L) - R = angle (n x R p - R (n x p)) to first order.
  const Vec3 from_axis = on_table - geometry.rotary_axis_point_mm;
  for (const auto& [source, n] : {std::pair(aoc, Vec3(Vec3::UnitX())), std::pair(boc, Vec3(Vec3::UnitY()))})
    EXPECT_LT(
        (moved_by(source, angle) - angle * (n.cross(turn * from_axis) - turn * n.cross(from_axis))).norm(),
        2.0 * second_order);
}

TEST(TrueGeometry, APlacementErrorOfTheRotaryAxisIsNotSeenAtAngleZero) {
  const MachineGeometry geometry = oblique_machine();
  ErrorValues errors;
  errors[xoc] = 0.1;
  errors[boc] = 0.01;
  EXPECT_LT(difference(true_stage_from_mcs(geometry, 0.0, errors), RigidTransform{}), 1e-12);
}

TEST(TrueGeometry, FixtureErrorsActInTheFixturesFrame) {
  RigidTransform mcs_from_part, mcs_from_fixture;
  mcs_from_part.translation_mm = {7.0, 8.0, 9.0};
  mcs_from_fixture.rotation = rotation_from_vector({0.0, 0.0, 0.5 * M_PI});
  mcs_from_fixture.translation_mm = {1.0, 2.0, 3.0};
  ErrorValues errors;
  errors[part_x] = 0.1;  // along y of the MCS
  EXPECT_LT((true_mcs_from_part(mcs_from_part, mcs_from_fixture, errors).translation_mm - Vec3(7.0, 8.1, 9.0))
                .norm(),
            1e-13);
  ErrorValues turned;
  turned[fixture_c] = 0.5 * M_PI;  // about the fixture's origin: (6, 6) becomes (-6, 6)
  EXPECT_LT((true_mcs_from_part(mcs_from_part, mcs_from_fixture, turned).translation_mm -
             Vec3(1.0 - 6.0, 2.0 + 6.0, 9.0))
                .norm(),
            1e-13);
}

}  // namespace
}  // namespace trueblade
