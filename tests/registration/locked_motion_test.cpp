// Locked degrees of freedom: the motion keeps them at zero, and its directions are its derivatives.
#include "registration/locked_motion.h"

#include <gtest/gtest.h>

#include "geometry/random.h"
#include "registration/rotation_jacobian.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

LockOptions locks(std::vector<Freedom> freedoms) {
  LockOptions options;
  options.freedoms = std::move(freedoms);
  options.part_from_frame.rotation = rotation_from_vector(Vec3(0.3, 0.5, -0.2));
  options.part_from_frame.translation_mm = Vec3(5.0, -7.0, 20.0);
  return options;
}

// (rho, tau) of the motion between two poses in the frame of the locks.
Vec6 motion_in_frame(const LockOptions& options, const RigidTransform& from, const RigidTransform& to) {
  const RigidTransform motion =
      options.part_from_frame.inverse() * to * from.inverse() * options.part_from_frame;
  Vec6 p;
  p << vector_from_rotation(motion.rotation), motion.translation_mm;
  return p;
}

TEST(LockedMotion, LargeRandomStepsNeverMoveALockedFreedom) {
  const LockOptions options = locks({Freedom::rotation_x, Freedom::translation_y});
  const RigidTransform initial = shapes::some_pose();
  const LockedMotion motion(options, initial);
  RigidTransform pose = initial;
  Rng rng(1, 0, "steps");
  const StepFrame frame{Vec3(3, 4, 5), 20.0};
  for (int k = 0; k < 20; ++k) {
    const FreeDirections free = motion.directions(pose, frame);
    ASSERT_EQ(free.cols(), 4);
    Vec6 random;
    random << rng.normal_vector(), rng.normal_vector();
    pose = motion.moved(pose, free * (free.transpose() * random), frame);
    const Vec6 p = motion_in_frame(options, initial, pose);
    EXPECT_NEAR(p[0], 0.0, 1e-13);             // rounding of composed rotations
    EXPECT_NEAR(p[4], 0.0, 1e-12);             // the same times coordinates of 60 mm
    EXPECT_GT(p.cwiseAbs().maxCoeff(), 0.01);  // and it does move
  }
}

TEST(LockedMotion, MovedFollowsTheStepToFirstOrder) {
  const LockOptions options = locks({Freedom::rotation_z});
  const RigidTransform initial = shapes::some_pose();
  const LockedMotion motion(options, initial);
  const StepFrame frame{Vec3(3, 4, 5), 20.0};
  Vec6 large = Vec6::Constant(2.0);
  const FreeDirections at_start = motion.directions(initial, frame);
  const RigidTransform pose = motion.moved(initial, at_start * (at_start.transpose() * large), frame);
  const FreeDirections free = motion.directions(pose, frame);
  for (Eigen::Index k = 0; k < free.cols(); ++k) {
    const double h = 1e-5;
    const Vec6 step = h * free.col(k);
    const RigidTransform moved = motion.moved(pose, step, frame);
    const Vec6 found = frame.scaled(step_between(pose, moved, frame.pivot_part_mm));
    EXPECT_LT((found - step).norm(), 1e-9);  // second order, h^2 / radius, and rounding 1e-14
  }
}

// R(rho + d) = R(J d) R(rho), by central differences: their error is h^2 / 6 and rounding 1e-16 / h.
TEST(RotationJacobian, IsTheDerivativeOfTheRotation) {
  constexpr double kStep = 1e-5;
  Rng rng(2, 0, "rotations");
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 rho = 3.0 * rng.uniform() * rng.normal_vector().normalized() * (trial % 4 == 0 ? 1e-9 : 1.0);
    const Mat3 jacobian = rotation_jacobian(rho);
    for (int k = 0; k < 3; ++k) {
      const auto turned = [&](double step) {
        return vector_from_rotation(rotation_from_vector(rho + step * Vec3::Unit(k)) *
                                    rotation_from_vector(rho).conjugate());
      };
      const Vec3 difference = (turned(kStep) - turned(-kStep)) / (2.0 * kStep);
      EXPECT_LT((jacobian.col(k) - difference).norm(), 1e-9) << rho.transpose();
    }
  }
}

TEST(LockedMotion, WithoutLocksAnyStepIsTaken) {
  const LockedMotion motion(LockOptions{}, shapes::some_pose());
  const StepFrame frame{Vec3(3, 4, 5), 20.0};
  EXPECT_FALSE(motion.any());
  EXPECT_EQ(motion.directions(shapes::some_pose(), frame), FreeDirections(FreeDirections::Identity(6, 6)));
}

}  // namespace
}  // namespace trueblade
