// The registration as a whole: it finds the pose, says what it did, and does not depend on what must not
// matter (origin, order of the points, threads).
#include "registration/register_scan.h"

#include <gtest/gtest.h>

#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kDegree = shapes::kPi / 180.0;

struct Case {
  Part part;
  RigidTransform truth = shapes::some_pose();
  std::vector<Vec3> points;
  ScanPoints scan;
  Vec3 centroid_mcs_mm;

  Case(Part p, std::size_t count, const Vec3& view, double sigma_mm) : part(std::move(p)) {
    points = shapes::points_on(part, count, view, sigma_mm, 1);
    scan = shapes::seen_from(truth, points);
    centroid_mcs_mm = shapes::centroid_of(scan.position_mcs_mm);
  }
  RigidTransform start(double distance_mm, double angle_rad, std::uint64_t trial = 0) const {
    return shapes::displaced(truth, distance_mm, angle_rad, truth * centroid_mcs_mm, 2, trial);
  }
};

TEST(RegisterScan, NoiseFreeScanOnFacetsReturnsToTheTruePose) {
  const Case c(shapes::blade(96, 88), 3400, Vec3(0.3, 1.0, 0.4), 0.0);
  const RegistrationTarget target(c.part);
  for (std::uint64_t trial = 0; trial < 4; ++trial) {
    const auto result = register_scan(target, c.scan, c.start(3.0, 3.0 * kDegree, trial), preset("default"));
    EXPECT_TRUE(is_converged(result.termination)) << full_report(result);
    const auto error = shapes::pose_error(result.part_from_mcs, c.truth, c.centroid_mcs_mm);
    EXPECT_LT(error.centroid_mm, 1e-7) << full_report(result);
    EXPECT_LT(error.rotation_rad, 1e-9);
    EXPECT_EQ(result.undetermined.size(), 0U);
  }
}

TEST(RegisterScan, PublishedClosedFormConvergesToTheSamePoseAsPointToPlane) {
  const Case c(shapes::blade(48, 44), 1500, Vec3(0.3, 1.0, 0.4), 0.003);
  const RegistrationTarget target(c.part);
  RegistrationOptions closed = preset("default");
  closed.step.method = StepMethod::unit_quaternion;
  closed.termination.statistical_step = 0.0;
  closed.termination.step_mm = 1e-9;
  closed.termination.maximum_iterations = 20000;
  closed.rejection.rule = RejectionRule::none;
  RegistrationOptions plane = preset("default");
  plane.rejection.rule = RejectionRule::none;
  plane.termination.statistical_step = 1e-6;
  const auto a = register_scan(target, c.scan, c.start(0.1, 0.1 * kDegree), closed);
  const auto b = register_scan(target, c.scan, c.start(0.1, 0.1 * kDegree), plane);
  const auto difference = shapes::pose_error(a.part_from_mcs, b.part_from_mcs, c.centroid_mcs_mm);
  // Both minimise the same sum of squared distances; the closed form converges linearly and stops at steps of
  // 1e-9 mm, a thousand of them from the minimum at a rate of 0.999.
  EXPECT_LT(difference.centroid_mm, 1e-5) << full_report(a) << full_report(b);
}

}  // namespace
}  // namespace trueblade
