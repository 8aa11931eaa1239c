// Rigid transforms: group identities and closed forms over random poses, down to angles of zero and up to pi.
#include "geometry/rigid_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/random.h"

namespace trueblade {
namespace {

constexpr double kUlp = 0x1p-52;
// A chain of a few rotations of vectors of the given length: some dozen roundings of half an ulp each.
double rounding_mm(double length_mm) {
  return 16.0 * kUlp * length_mm;
}

RigidTransform random_pose(Rng& rng) {
  return {rotation_from_vector(2.0 * rng.normal_vector()), 100.0 * rng.normal_vector()};
}

// The matrix of a rotation by Rodrigues' formula.
Mat3 rodrigues(const Vec3& unit_axis, double angle_rad) {
  Mat3 cross;
  cross << 0, -unit_axis.z(), unit_axis.y(), unit_axis.z(), 0, -unit_axis.x(), -unit_axis.y(), unit_axis.x(),
      0;
  return Mat3::Identity() + std::sin(angle_rad) * cross + (1.0 - std::cos(angle_rad)) * cross * cross;
}

TEST(RigidTransform, CompositionAppliesTheRightOneFirst) {
  Rng rng(1, 0, "compose");
  for (int i = 0; i < 100; ++i) {
    const RigidTransform a_from_b = random_pose(rng), b_from_c = random_pose(rng);
    const Vec3 point_c = 100.0 * rng.normal_vector();
    const RigidTransform a_from_c = a_from_b * b_from_c;
    EXPECT_NEAR((a_from_c * point_c - a_from_b * (b_from_c * point_c)).norm(), 0.0, rounding_mm(1000.0));
    EXPECT_NEAR(a_from_c.rotation.norm(), 1.0, 2.0 * kUlp);
    EXPECT_NEAR((a_from_b.inverse() * (a_from_b * point_c) - point_c).norm(), 0.0, rounding_mm(1000.0));
    EXPECT_NEAR((a_from_b * a_from_b.inverse()).translation_mm.norm(), 0.0, rounding_mm(500.0));
  }
}

TEST(RigidTransform, ProductsStayUnit) {
  Rng rng(2, 0, "drift");
  const RigidTransform step = random_pose(rng);
  RigidTransform pose;
  for (int i = 0; i < 10'000; ++i) pose = step * pose;
  EXPECT_NEAR(pose.rotation.norm(), 1.0,
              2.0 * kUlp);  // without normalising it would drift by sqrt(10000) ulps
}

TEST(RigidTransform, RotationFromVectorIsRodrigues) {
  Rng rng(3, 0, "rodrigues");
  for (const double angle_rad :
       {0.0, 1e-300, 1e-160, 1e-12, 1e-8, 1.1e-8, 1e-4, 0.1, 1.0, 3.0, std::numbers::pi, 5.0}) {
    const Vec3 axis = rng.normal_vector().normalized();
    const Eigen::Quaterniond rotation = rotation_from_vector(angle_rad * axis);
    EXPECT_NEAR((rotation.toRotationMatrix() - rodrigues(axis, angle_rad)).norm(), 0.0, 16.0 * kUlp)
        << angle_rad;
    EXPECT_NEAR(rotation.norm(), 1.0, 2.0 * kUlp);
  }
}

TEST(RigidTransform, VectorFromRotationIsTheInverse) {
  Rng rng(4, 0, "logarithm");
  const double pi = std::numbers::pi;
  for (const double angle_rad :
       {0.0, 1e-300, 1e-160, 1e-15, 1e-8, 1e-4, 0.1, 1.0, 3.0, pi - 1e-3, pi - 1e-8, pi - 1e-14}) {
    const Vec3 vector = angle_rad * rng.normal_vector().normalized();
    const Eigen::Quaterniond rotation = rotation_from_vector(vector);
    const Vec3 back = vector_from_rotation(rotation);
    // Relative to the angle: tiny rotations keep all their digits.
    EXPECT_NEAR((back - vector).norm(), 0.0, 8.0 * kUlp * angle_rad) << angle_rad;
    const Eigen::Quaterniond same_rotation(-rotation.coeffs());
    EXPECT_NEAR((vector_from_rotation(same_rotation) - vector).norm(), 0.0, 8.0 * kUlp * angle_rad)
        << angle_rad;
  }
}

TEST(RigidTransform, VectorFromRotationTakesTheShortWay) {
  const Vec3 back = vector_from_rotation(rotation_from_vector({0.0, 0.0, 4.0}));
  EXPECT_NEAR((back - Vec3(0.0, 0.0, 4.0 - 2.0 * std::numbers::pi)).norm(), 0.0, 8.0 * kUlp);
}

TEST(RigidTransform, MovedAboutFollowsItsFormula) {
  Rng rng(5, 0, "moved");
  for (int i = 0; i < 100; ++i) {
    const RigidTransform pose = random_pose(rng);
    Vec6 step;
    step << rng.normal_vector(), 10.0 * rng.normal_vector();
    const Vec3 pivot_mm = 100.0 * rng.normal_vector(), point_mm = 100.0 * rng.normal_vector();
    const Vec3 axis = step.head<3>().normalized();
    const Vec3 expected =
        rodrigues(axis, step.head<3>().norm()) * (pose * point_mm - pivot_mm) + pivot_mm + step.tail<3>();
    EXPECT_NEAR((moved_about(pose, step, pivot_mm) * point_mm - expected).norm(), 0.0, rounding_mm(1000.0));
  }
}

TEST(RigidTransform, ThePivotMovesByTheTranslationAlone) {
  Rng rng(6, 0, "pivot");
  const RigidTransform pose = random_pose(rng);
  const Vec3 pivot_mm(10.0, 20.0, 30.0);
  Vec6 step;
  step << 0.3, -0.2, 0.5, 1.0, 2.0, 3.0;
  const Vec3 pivot_in_source = pose.inverse() * pivot_mm;
  EXPECT_NEAR((moved_about(pose, step, pivot_mm) * pivot_in_source - Vec3(11.0, 22.0, 33.0)).norm(), 0.0,
              rounding_mm(500.0));
}

TEST(RigidTransform, StepBetweenIsTheInverseOfMovedAbout) {
  Rng rng(7, 0, "step");
  const double pi = std::numbers::pi;
  for (const double angle_rad : {0.0, 1e-300, 1e-12, 1e-6, 1e-2, 1.0, 3.0, pi - 1e-6, pi - 1e-12}) {
    for (int i = 0; i < 20; ++i) {
      const RigidTransform pose = random_pose(rng);
      const Vec3 pivot_mm = 100.0 * rng.normal_vector();
      Vec6 step;
      step << angle_rad * rng.normal_vector().normalized(), 10.0 * rng.normal_vector();
      const RigidTransform moved = moved_about(pose, step, pivot_mm);
      const Vec6 back = step_between(pose, moved, pivot_mm);
      // The rotation of the poses themselves is known to an ulp of 1 only; so is the step's angle. (Past pi -
      // rounding the axis may come back reversed; pi - 1e-12 is 4500 ulps away.)
      EXPECT_NEAR((back - step).head<3>().norm(), 0.0, 16.0 * kUlp) << angle_rad;
      EXPECT_NEAR((back - step).tail<3>().norm(), 0.0, rounding_mm(1000.0)) << angle_rad;
      const RigidTransform again = moved_about(pose, back, pivot_mm);
      EXPECT_NEAR(rotation_angle_between(again, moved), 0.0, 16.0 * kUlp);
      EXPECT_NEAR((again.translation_mm - moved.translation_mm).norm(), 0.0, rounding_mm(1000.0));
      EXPECT_NEAR(rotation_angle_between(pose, moved), angle_rad, 16.0 * kUlp);
    }
  }
}

TEST(RigidTransform, IsFiniteSeesEveryNumber) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
  EXPECT_TRUE(is_finite(RigidTransform{}));
  for (const double value : bad) {
    for (int i = 0; i < 4; ++i) {
      RigidTransform transform;
      transform.rotation.coeffs()[i] = value;
      EXPECT_FALSE(is_finite(transform));
    }
    for (int i = 0; i < 3; ++i) {
      RigidTransform transform;
      transform.translation_mm[i] = value;
      EXPECT_FALSE(is_finite(transform));
    }
  }
}

}  // namespace
}  // namespace trueblade
