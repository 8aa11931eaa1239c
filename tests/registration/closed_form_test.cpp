// Absolute orientation in closed form: known answers, two closed forms and Ceres against one another, planar
// and reflected data, weights, bad input.
#include "registration/closed_form.h"

#include <gtest/gtest.h>

#include <limits>

#include "geometry/error.h"
#include "geometry/random.h"
#include "registration/cross_check.h"

namespace trueblade {
namespace {

struct Pairs {
  std::vector<Vec3> measured, nominal;
  std::vector<double> weights;
};

RigidTransform random_pose(Rng& rng) {
  RigidTransform pose;
  pose.rotation = rotation_from_vector(rng.uniform() * 3.0 * rng.normal_vector().normalized());
  pose.translation_mm = 100.0 * rng.normal_vector();
  return pose;
}

// Points of a box of the given half sizes, moved by `pose`, with noise and random weights.
Pairs random_pairs(Rng& rng, int count, const Vec3& half_size, const RigidTransform& pose, double noise_mm) {
  Pairs pairs;
  for (int i = 0; i < count; ++i) {
    pairs.measured.push_back(half_size.cwiseProduct(rng.normal_vector()));
    pairs.nominal.push_back(pose * pairs.measured.back() + noise_mm * rng.normal_vector());
    pairs.weights.push_back(0.1 + rng.uniform());
  }
  return pairs;
}

TEST(ClosedForm, ReturnsTheMotionOfExactPairs) {
  for (std::uint64_t trial = 0; trial < 1000; ++trial) {
    Rng rng(1, trial, "exact pairs");
    const RigidTransform truth = random_pose(rng);
    const Pairs p = random_pairs(rng, 3 + static_cast<int>(trial % 20), Vec3(40, 30, 20), truth, 0.0);
    const auto q = absolute_orientation_by_quaternion(p.measured, p.nominal, p.weights);
    const auto s = absolute_orientation_by_svd(p.measured, p.nominal, p.weights);
    // The eigenvector's rounding, a few ulps of the largest eigenvalue over the gap to the next. Three random
    // points are at worst a sliver 1e-4 as wide as long: 1e-16 * 10 / 1e-4 = 1e-11.
    EXPECT_LT(rotation_angle_between(q, truth), 1e-10) << trial;
    EXPECT_LT(rotation_angle_between(s, truth), 1e-10) << trial;
    EXPECT_LT((q.translation_mm - truth.translation_mm).norm(), 1e-8) << trial;
  }
}

// The optimum of a least-squares problem is unique where the points are not degenerate: two closed forms and
// an iteration that knows neither must find the same pose. Boxes, plane patches, needles of 40 mm by 1 mm by
// 0.1 mm, whose turn about their axis hangs on their thickness, and cubes; residuals of 1 mm and of 1 um.
TEST(ClosedForm, AgreesWithSvdAndCeresOnThousandsOfRandomProblems) {
  for (std::uint64_t trial = 0; trial < 2000; ++trial) {
    Rng rng(2, trial, "problems");
    const RigidTransform truth = random_pose(rng);
    const Vec3 shapes[] = {Vec3(40, 30, 20), Vec3(40, 30, 0), Vec3(40, 1, 0.1), Vec3(40, 40, 40)};
    const Pairs p = random_pairs(rng, 8, shapes[trial % 4], truth, trial % 3 == 0 ? 1.0 : 0.001);
    const auto q = absolute_orientation_by_quaternion(p.measured, p.nominal, p.weights);
    const auto s = absolute_orientation_by_svd(p.measured, p.nominal, p.weights);
    const auto c = absolute_orientation_by_ceres(p.measured, p.nominal, p.weights, truth);
    const Vec3& probe = p.measured[0];
    EXPECT_LT(rotation_angle_between(q, s), 1e-10) << trial;
    EXPECT_LT((q * probe - s * probe).norm(), 1e-9) << trial;
    EXPECT_LT(rotation_angle_between(q, c), 1e-10) << trial;
    EXPECT_LT((q * probe - c * probe).norm(), 1e-9) << trial;
  }
}

// Mirrored points: the best improper transform is exact, the best rotation is not; both closed forms must
// return a rotation, and the same one.
TEST(ClosedForm, ReflectedPairsStillGiveAProperRotation) {
  for (std::uint64_t trial = 0; trial < 500; ++trial) {
    Rng rng(3, trial, "reflected");
    Pairs p = random_pairs(rng, 12, Vec3(40, 25, 10), random_pose(rng), 0.0);
    for (Vec3& n : p.nominal) n.z() = -n.z();
    const auto q = absolute_orientation_by_quaternion(p.measured, p.nominal, p.weights);
    const auto s = absolute_orientation_by_svd(p.measured, p.nominal, p.weights);
    // From elsewhere: from a saddle point Ceres would not move.
    RigidTransform elsewhere = q;
    elsewhere.rotation = rotation_from_vector(0.3 * rng.normal_vector().normalized()) * q.rotation;
    const auto c = absolute_orientation_by_ceres(p.measured, p.nominal, p.weights, elsewhere);
    EXPECT_NEAR(s.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
    EXPECT_LT(rotation_angle_between(q, s), 1e-10) << trial;
    EXPECT_LT(rotation_angle_between(q, c), 1e-10) << trial;
    EXPECT_LT((q * p.measured[0] - c * p.measured[0]).norm(), 1e-9) << trial;
  }
}

TEST(ClosedForm, WeightOfTwoEqualsThePointTwice) {
  Rng rng(4, 0, "weights");
  Pairs p = random_pairs(rng, 10, Vec3(40, 30, 20), random_pose(rng), 0.5);
  std::fill(p.weights.begin(), p.weights.end(), 1.0);
  Pairs doubled = p;
  p.weights[3] = 2.0;
  p.weights[5] = 0.0;
  doubled.measured.push_back(p.measured[3]);
  doubled.nominal.push_back(p.nominal[3]);
  doubled.weights.push_back(1.0);
  for (auto* v : {&doubled.measured, &doubled.nominal}) v->erase(v->begin() + 5);
  doubled.weights.erase(doubled.weights.begin() + 5);
  const auto a = absolute_orientation_by_quaternion(p.measured, p.nominal, p.weights);
  const auto b = absolute_orientation_by_quaternion(doubled.measured, doubled.nominal, doubled.weights);
  EXPECT_LT(rotation_angle_between(a, b), 1e-13);  // rounding of sums over ten terms
}

TEST(ClosedForm, DoesNotDependOnTheOrigin) {
  Rng rng(5, 0, "origin");
  Pairs p = random_pairs(rng, 50, Vec3(40, 30, 20), random_pose(rng), 0.01);
  const auto near = absolute_orientation_by_quaternion(p.measured, p.nominal, p.weights);
  const Vec3 far(10000.0, -10000.0, 10000.0);
  for (Vec3& m : p.measured) m += far;
  const auto moved = absolute_orientation_by_quaternion(p.measured, p.nominal, p.weights);
  // Coordinates of 1.7e4 mm carry 2e-12 mm of rounding, over an extent of 40 mm: 5e-14 rad per point.
  EXPECT_LT(rotation_angle_between(near, moved), 1e-12);
  EXPECT_LT((moved * (p.measured[0]) - near * Vec3(p.measured[0] - far)).norm(), 1e-10);
}

TEST(ClosedForm, RefusesBadWeightsAndCollinearPoints) {
  Rng rng(6, 0, "bad");
  Pairs p = random_pairs(rng, 5, Vec3(40, 30, 20), random_pose(rng), 0.0);
  auto bad = p.weights;
  bad[2] = -1.0;
  EXPECT_THROW(absolute_orientation_by_quaternion(p.measured, p.nominal, bad), InputError);
  bad[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(absolute_orientation_by_svd(p.measured, p.nominal, bad), InputError);
  std::fill(bad.begin(), bad.end(), 0.0);
  EXPECT_THROW(absolute_orientation_by_quaternion(p.measured, p.nominal, bad), InputError);
  bad[0] = bad[1] = 1.0;
  EXPECT_THROW(absolute_orientation_by_quaternion(p.measured, p.nominal, bad), InputError);
}

}  // namespace
}  // namespace trueblade
