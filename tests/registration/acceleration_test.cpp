// Extrapolation lengths by closed form; the accelerator on sequences whose limit is known.
#include "registration/acceleration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trueblade {
namespace {

const Vec3 kPosition(-3.0, -1.0, 0.0);

TEST(Extrapolation, LinearLengthIsWhereAFallingLineReachesZero) {
  const auto line = [](double v) { return 0.25 * (4.0 - v); };  // zero at v = 4
  const Vec3 rms(line(-3.0), line(-1.0), line(0.0));
  ASSERT_TRUE(linear_extrapolation(kPosition, rms).has_value());
  EXPECT_NEAR(*linear_extrapolation(kPosition, rms), 4.0, 1e-14);
}

TEST(Extrapolation, QuadraticLengthIsTheVertexOfAnUpwardParabola) {
  const auto parabola = [](double v) { return 0.5 + 0.1 * (v - 2.5) * (v - 2.5); };
  const Vec3 rms(parabola(-3.0), parabola(-1.0), parabola(0.0));
  ASSERT_TRUE(quadratic_extrapolation(kPosition, rms).has_value());
  EXPECT_NEAR(*quadratic_extrapolation(kPosition, rms), 2.5, 1e-13);
}

TEST(Extrapolation, NoLengthWhenTheLineRisesOrTheParabolaOpensDownwards) {
  EXPECT_FALSE(linear_extrapolation(kPosition, Vec3(1.0, 2.0, 3.0)).has_value());
  EXPECT_FALSE(linear_extrapolation(kPosition, Vec3(1.0, 1.0, 1.0)).has_value());
  const auto downward = [](double v) { return 5.0 - 0.1 * (v + 9.0) * (v + 9.0); };
  EXPECT_FALSE(
      quadratic_extrapolation(kPosition, Vec3(downward(-3.0), downward(-1.0), downward(0.0))).has_value());
  EXPECT_FALSE(quadratic_extrapolation(kPosition, Vec3(3.0, 1.0, 0.0)).has_value());  // a straight line
}

RigidTransform pose_at(double s) {
  RigidTransform pose;
  pose.rotation = rotation_from_vector(Vec3(0.0, 0.0, 0.01 * s));
  pose.translation_mm = Vec3(s, 0.0, 0.0);
  return pose;
}

AccelerationOptions extrapolation(ExtrapolatedPart part) {
  AccelerationOptions options;
  options.method = AccelerationMethod::extrapolation;
  options.part = part;
  return options;
}

TEST(Accelerator, ProposesAPoseFurtherAlongThreeAlignedSteps) {
  for (const ExtrapolatedPart part :
       {ExtrapolatedPart::together, ExtrapolatedPart::rotation_only, ExtrapolatedPart::translation_only,
        ExtrapolatedPart::separately, ExtrapolatedPart::normalised}) {
    Accelerator accelerator(extrapolation(part), Vec3::Zero(), 30.0);
    EXPECT_FALSE(accelerator.propose(pose_at(-1), pose_at(0), 0.9));
    EXPECT_FALSE(accelerator.propose(pose_at(0), pose_at(1), 0.8));
    const auto further = accelerator.propose(pose_at(1), pose_at(2), 0.7);
    ASSERT_TRUE(further) << to_string(part);
    EXPECT_NEAR(further->rotation.norm(), 1.0, 1e-15);
    // The line through 0.9, 0.8, 0.7 at 0, 1, 2 reaches zero at 9, seven further on.
    const double angle = vector_from_rotation(further->rotation).z();
    const bool turns = part != ExtrapolatedPart::translation_only,
               shifts = part != ExtrapolatedPart::rotation_only;
    // The chord of a quaternion is straight to second order: (0.09 rad)^2 / 24 of 0.09 rad.
    EXPECT_NEAR(angle, turns ? 0.09 : 0.02, 1e-4) << to_string(part);
    EXPECT_NEAR(further->translation_mm.x(), shifts ? 9.0 : 2.0, 1e-2) << to_string(part);
  }
}

TEST(Accelerator, LengthIsCappedAtAMultipleOfTheLastStep) {
  Accelerator accelerator(extrapolation(ExtrapolatedPart::together), Vec3::Zero(), 30.0);
  accelerator.propose(pose_at(-1), pose_at(0), 0.902);
  accelerator.propose(pose_at(0), pose_at(1), 0.901);
  const auto further = accelerator.propose(pose_at(1), pose_at(2), 0.900);  // zero 900 steps further on
  ASSERT_TRUE(further);
  EXPECT_NEAR(further->translation_mm.x(), 2.0 + 15.0, 0.05);
}

TEST(Accelerator, ProposesNothingAroundACorner) {
  Accelerator accelerator(extrapolation(ExtrapolatedPart::together), Vec3::Zero(), 30.0);
  RigidTransform corner = pose_at(1);
  corner.translation_mm.y() = 0.5;  // 26 degrees
  accelerator.propose(pose_at(-1), pose_at(0), 0.9);
  accelerator.propose(pose_at(0), pose_at(1), 0.8);
  corner.translation_mm.x() = 2.0;
  EXPECT_FALSE(accelerator.propose(pose_at(1), corner, 0.7));
}

// q and -q are one rotation: the same poses with flipped signs must give the same proposal.
TEST(Accelerator, DoesNotSeeTheSignOfTheQuaternion) {
  Accelerator plain(extrapolation(ExtrapolatedPart::together), Vec3::Zero(), 30.0);
  Accelerator flipped(extrapolation(ExtrapolatedPart::together), Vec3::Zero(), 30.0);
  const auto flip = [](RigidTransform pose) {
    pose.rotation.coeffs() *= -1.0;
    return pose;
  };
  plain.propose(pose_at(-1), pose_at(0), 0.9);
  flipped.propose(pose_at(-1), pose_at(0), 0.9);
  plain.propose(pose_at(0), pose_at(1), 0.8);
  flipped.propose(pose_at(0), flip(pose_at(1)), 0.8);
  const auto a = plain.propose(pose_at(1), pose_at(2), 0.7);
  const auto b = flipped.propose(flip(pose_at(1)), pose_at(2), 0.7);
  ASSERT_TRUE(a && b);
  EXPECT_LT(rotation_angle_between(*a, *b), 1e-15);
}

// The registration vector is taken about the scan's centroid: moving the measurement frame changes nothing.
TEST(Accelerator, DoesNotDependOnTheOriginOfTheScan) {
  const Vec3 shift(10000.0, -5000.0, 2000.0);
  RigidTransform mcs_from_moved;
  mcs_from_moved.translation_mm = shift;
  Accelerator near(extrapolation(ExtrapolatedPart::together), Vec3(1, 2, 3), 30.0);
  Accelerator far(extrapolation(ExtrapolatedPart::together), Vec3(1, 2, 3) - shift, 30.0);
  std::optional<RigidTransform> a, b;
  for (int k = 0; k < 3; ++k) {
    a = near.propose(pose_at(k - 1), pose_at(k), 0.9 - 0.1 * k);
    b = far.propose(pose_at(k - 1) * mcs_from_moved, pose_at(k) * mcs_from_moved, 0.9 - 0.1 * k);
  }
  ASSERT_TRUE(a && b);
  // 1e4 mm times the rounding of a rotation, a few 1e-16.
  EXPECT_LT((*a * Vec3(1, 2, 3) - *b * Vec3(Vec3(1, 2, 3) - shift)).norm(), 1e-10);
}

// Anderson mixing solves a linear fixed-point problem in six dimensions in about as many steps, where the
// plain iteration gains a tenth per step.
TEST(Accelerator, AndersonMixingSolvesALinearFixedPointProblem) {
  AccelerationOptions options;
  options.method = AccelerationMethod::anderson;
  options.anderson_depth = 6;
  Accelerator accelerator(options, Vec3::Zero(), 1.0);
  const Vec6 rates = (Vec6() << 0.9, 0.8, 0.7, 0.6, 0.5, 0.4).finished();
  const auto map = [&](const RigidTransform& pose) {
    const Vec6 at = step_between(RigidTransform{}, pose, Vec3::Zero());
    return moved_about(RigidTransform{}, rates.cwiseProduct(at), Vec3::Zero());
  };
  RigidTransform pose = moved_about(RigidTransform{}, Vec6::Constant(1e-3), Vec3::Zero());
  for (int k = 0; k < 12; ++k) {
    const RigidTransform next = map(pose);
    pose = accelerator.propose(pose, next, 0.0).value_or(next);
  }
  // Rotations of 1e-3 compose linearly to 1e-6 of themselves; plain iteration would still be at 2.8e-4.
  EXPECT_LT(step_between(RigidTransform{}, pose, Vec3::Zero()).norm(), 1e-6);
}

}  // namespace
}  // namespace trueblade
