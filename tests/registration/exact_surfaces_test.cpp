// Registration to the CAD surfaces themselves: the error of the facets is gone.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "part/exact_closest_point.h"
#include "part/turbine_blade.h"
#include "registration/correspondences.h"
#include "registration/register_scan.h"
#include "registration/rotation_jacobian.h"
#include "tests/registration/moved_blade.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kDegree = shapes::kPi / 180.0;

FacetingOptions coarse_faceting() {
  FacetingOptions faceting;
  faceting.chord_tolerance_mm = 0.02;
  return faceting;
}

// The demonstration blade with coarse facets, 0.02 mm from its surfaces.
const Part& coarse_blade() {
  static const Part part = make_turbine_blade(TurbineBladeParameters{}, coarse_faceting());
  return part;
}

// Points of the CAD surfaces: a point of a facet facing `view`, evaluated at its surface parameters.
std::vector<Vec3> points_on_surfaces(const Part& part, std::size_t count, const Vec3& view) {
  const ClosestPointTree tree(part.model);
  std::vector<Vec3> points;
  for (const Vec3& p : shapes::points_on(part, count, view, 0.0, 11)) {
    const auto foot = refine_to_exact(part, tree.query(p), p);
    if (foot) points.push_back(foot->foot.point_mm);
  }
  return points;
}

TEST(ExactSurfaces, NoiseFreeScanComesBackWithinANanometreDespiteCoarseFacets) {
  const Part& part = coarse_blade();
  ASSERT_TRUE(part.exact);
  const auto points = points_on_surfaces(part, 1500, Vec3(0.3, 1.0, 0.4));
  ASSERT_GT(points.size(), 1400U);
  const RigidTransform truth = shapes::some_pose();
  const ScanPoints scan = shapes::seen_from(truth, points);
  const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
  const RegistrationTarget target(part);
  const RigidTransform start = shapes::displaced(truth, 0.5, 0.5 * kDegree, shapes::centroid_of(points), 2);

  const auto exact = register_scan(target, scan, start, preset("default"));
  const auto error = shapes::pose_error(exact.part_from_mcs, truth, centroid_mcs);
  EXPECT_TRUE(is_converged(exact.termination)) << full_report(exact);
  EXPECT_LT(error.centroid_mm, 1e-6) << full_report(exact);
  EXPECT_LT(error.rotation_rad, 1e-8);  // 1e-6 mm over the scan's radius of 40 mm is 2.5e-8

  RegistrationOptions on_facets = preset("default");
  on_facets.exact_surfaces = false;
  const auto facets = register_scan(target, scan, start, on_facets);
  EXPECT_GT(shapes::pose_error(facets.part_from_mcs, truth, centroid_mcs).centroid_mm,
            1e-4);  // why it matters
  EXPECT_GT(facets.rms_mm, 1e-4);
}

// Round patches of the airfoil, 5 to 12 mm, slide: along the surface, and about its normal. What they do not
// determine must be found and stay where it is, or the registration wanders about for millimetres.
TEST(ExactSurfaces, PatchesOfTheBladeThatSlideAreFound) {
  const Part& part = coarse_blade();
  const RegistrationTarget target(part);
  const RigidTransform truth = shapes::some_pose();
  Rng noise(5, 0, "noise of the patches");
  std::vector<Vec3> airfoil;
  const ClosestPointTree tree(part.model);
  for (const Vec3& p : shapes::points_on(part, 20000, Vec3(0.1, 1.0, 0.1), 0.0, 9)) {
    const auto foot = refine_to_exact(part, tree.query(p), p);
    if (foot && p.z() > 3.0)
      airfoil.push_back(foot->foot.point_mm + 0.003 * noise.normal() * foot->foot.normal);
  }
  int not_converged = 0, patches = 0;
  for (const bool exact : {true, false})
    for (const double radius_mm : {5.0, 8.0, 12.0})
      for (std::uint64_t trial = 0; trial < 10; ++trial) {
        Rng rng(3, trial, "middle of the patch");
        const Vec3 middle =
            airfoil[static_cast<std::size_t>(rng.uniform() * static_cast<double>(airfoil.size()))];
        std::vector<Vec3> patch;
        for (const Vec3& p : airfoil)
          if ((p - middle).norm() < radius_mm && patch.size() < 300) patch.push_back(p);
        if (patch.size() < 50) continue;
        const ScanPoints scan = shapes::seen_from(truth, patch);
        const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
        RegistrationOptions options = preset("default");
        options.exact_surfaces = exact;
        const auto result = register_scan(
            target, scan, shapes::displaced(truth, 0.1, 0.002, truth * centroid_mcs, 2, trial), options);
        ++patches;
        not_converged += is_converged(result.termination) ? 0 : 1;
        // 0.1 mm away at the start; what is not determined stays there. Facets that are 0.02 mm off put what
        // they do determine further away.
        EXPECT_LT(shapes::pose_error(result.part_from_mcs, truth, centroid_mcs).centroid_mm,
                  exact ? 0.3 : 1.0)
            << full_report(result);
      }
  EXPECT_GT(patches, 40);
  EXPECT_LE(not_converged, 1);
}

// Root, platform and a little of the airfoil: more than half of the points lie on planes, which the facets
// meet to the last digit. The rest, off by the facets' chord error, must not become outliers by that measure.
TEST(ExactSurfaces, PlanesDoNotTurnTheRestIntoOutliers) {
  const Part& part = coarse_blade();
  const RigidTransform truth = shapes::some_pose();
  const RegistrationTarget target(part);
  std::vector<Vec3> points =
      points_on_surfaces(part, 400, Vec3(std::sin(85.0 * kDegree), std::cos(85.0 * kDegree), 0.0));
  std::size_t on_airfoil = 0;
  std::erase_if(points, [&](const Vec3& p) { return p.z() > 3.0 && on_airfoil++ % 8 != 0; });
  const ScanPoints scan = shapes::seen_from(truth, points);
  const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
  for (std::uint64_t trial = 0; trial < 10; ++trial) {
    const auto result = register_scan(
        target, scan, shapes::displaced(truth, 0.2, 0.2 * kDegree, truth * centroid_mcs, 2, trial),
        preset("default"));
    EXPECT_TRUE(is_converged(result.termination)) << full_report(result);
    EXPECT_EQ(result.outliers, 0U) << full_report(result);
    EXPECT_LT(shapes::pose_error(result.part_from_mcs, truth, centroid_mcs).centroid_mm, 1e-6);
  }
}

TEST(ExactSurfaces, CrossCheckByCeresAgrees) {
  const Part& part = coarse_blade();
  std::vector<Vec3> points = points_on_surfaces(part, 1000, Vec3(0.3, 1.0, 0.4));
  const ClosestPointTree tree(part.model);
  Rng rng(6, 0, "noise");
  for (Vec3& p : points) p += 0.003 * rng.normal() * refine_to_exact(part, tree.query(p), p)->foot.normal;
  const RigidTransform truth = shapes::some_pose();
  RegistrationOptions options = preset("default");
  options.cross_check = true;
  const auto result = register_scan(RegistrationTarget(part), shapes::seen_from(truth, points),
                                    shapes::displaced(truth, 0.2, 0.2 * kDegree, Vec3(0, 0, 40), 2), options);
  ASSERT_TRUE(result.cross_check);
  EXPECT_TRUE(result.cross_check->agrees) << result.cross_check->summary;
}

TEST(ExactSurfaces, RegistrationDoesNotDependOnThePartsOriginTenMetresAway) {
  RigidTransform moved_from_part;
  moved_from_part.translation_mm = Vec3(-8000.0, 3000.0, 5000.0);
  const Part moved_part = moved_turbine_blade(moved_from_part.translation_mm, coarse_faceting());
  std::vector<Vec3> points = points_on_surfaces(coarse_blade(), 1000, Vec3(0.3, 1.0, 0.4));
  Rng rng(6, 0, "noise");
  for (Vec3& p : points) p += 0.003 * rng.normal_vector();
  const RigidTransform truth = shapes::some_pose();
  const ScanPoints scan = shapes::seen_from(truth, points);
  const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
  const RigidTransform start = shapes::displaced(truth, 0.2, 0.2 * kDegree, truth * centroid_mcs, 2);
  RegistrationOptions options = preset("default");
  options.termination.statistical_step = 1e-6;
  const auto a = register_scan(RegistrationTarget(coarse_blade()), scan, start, options);
  const auto b = register_scan(RegistrationTarget(moved_part), scan, moved_from_part * start, options);
  EXPECT_TRUE(is_converged(a.termination) && is_converged(b.termination)) << full_report(a) << full_report(b);
  EXPECT_EQ(b.is_inlier, a.is_inlier);
  const auto difference =
      shapes::pose_error(b.part_from_mcs, moved_from_part * a.part_from_mcs, centroid_mcs);
  // The kernel facets the moved part anew, so that the ways to the minimum differ; each stops within 1e-6 of
  // the pose's standard uncertainty, sqrt(6) in the largest component.
  const Mat3 covariance = a.covariance.bottomRightCorner<3, 3>();
  const double steps_mm = 2.0 * 1e-6 * std::sqrt(6.0 * covariance.trace());
  const double rounding_mm = shapes::rounding_of_the_centroid_mm(a, moved_from_part.translation_mm.norm());
  EXPECT_LT(difference.centroid_mm, steps_mm + rounding_mm);
  // The scan reaches more than 10 mm from its middle in every direction but one.
  EXPECT_LT(difference.rotation_rad, (steps_mm + rounding_mm) / 10.0);
}

// Correspondences on the CAD surfaces at a pose.
Correspondences on_surfaces(const RegistrationTarget& target, const std::vector<Vec3>& points,
                            const RigidTransform& pose, const StepFrame& frame) {
  const RegistrationOptions options;
  CorrespondenceFinder finder(target, options, points, true);
  Correspondences c;
  finder.find(pose, frame, c);
  return c;
}

// Facets keep the angular tolerance of the faceting; a way to the closest point that differs from their
// normal by twice that comes from an edge.
bool comes_from_an_edge(const Correspondences& c, std::size_t i) {
  const Vec3 normal = c.jacobian.col(static_cast<Eigen::Index>(i)).tail<3>();
  const double cosine = normal.dot(coarse_blade().model.facet_normal(c.closest[i].facet));
  return cosine < std::cos(2.0 * coarse_faceting().angular_tolerance_rad);
}

// Points 0.15 mm from places all over the part whose closest points lie on edges (true), or on faces.
std::map<bool, std::vector<Vec3>> points_outside(const RegistrationTarget& target) {
  const FacetModel& model = target.model();
  std::vector<Vec3> all;
  Rng rng(8, 0, "lifts");
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
    const auto [a, b, c] = model.corners_mm(facet);
    const double v = rng.uniform(), w = rng.uniform() * (1.0 - v);
    const Vec3 lift = model.facet_normal(facet) + rng.normal_vector();
    all.push_back(a + v * (b - a) + w * (c - a) + 0.15 * lift.normalized());
  }
  const Correspondences c = on_surfaces(target, all, {}, {});
  std::map<bool, std::vector<Vec3>> points;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!c.is_exact[i]) continue;
    std::vector<Vec3>& of_its_place = points[comes_from_an_edge(c, i)];
    if (std::abs(c.distance_mm[i]) > 0.05 && of_its_place.size() < 500) of_its_place.push_back(all[i]);
  }
  return points;
}

// d(distance)/d(pose) by central differences, the closest point of the CAD surfaces found anew each time. Six
// derivatives are of small steps at the pose, three of the rotation vector of a large turn, as the
// cross-check has it.
TEST(ExactSurfaces, JacobianIsTheDerivativeOfTheDistance) {
  const RegistrationTarget target(coarse_blade());
  const Vec3 turn(0.9, -0.4, 0.7);
  const StepFrame frame{Vec3(3, 5, 20), 17.0};
  RigidTransform pose;
  pose.rotation = rotation_from_vector(turn);
  pose.translation_mm = Vec3(1, 2, 3);
  const auto moved = [&](Eigen::Index k, double step) {
    if (k < 6) return moved_about(pose, frame.unscaled(step * Vec6::Unit(k)), frame.pivot_part_mm);
    RigidTransform turned;
    turned.rotation = rotation_from_vector(turn + step / frame.radius_mm * Vec3::Unit(k - 6));
    turned.translation_mm =
        frame.pivot_part_mm +
        turned.rotation * (pose.inverse().rotation * (pose.translation_mm - frame.pivot_part_mm));
    return turned;
  };
  constexpr double kStep = 1e-5;
  // A rotation moves a point by up to this many times its step: nothing is farther than 75 mm from the pivot.
  const double lever = 75.0 / frame.radius_mm;
  for (const auto& [from_edges, points_part] : points_outside(target)) {
    const std::vector<Vec3> points = shapes::seen_from(pose, points_part).position_mcs_mm;
    const Correspondences here = on_surfaces(target, points, pose, frame);
    std::size_t compared = 0, even = 0;
    for (Eigen::Index k = 0; k < 9; ++k) {
      const Correspondences forward = on_surfaces(target, points, moved(k, kStep), frame);
      const Correspondences back = on_surfaces(target, points, moved(k, -kStep), frame);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec6 column = here.jacobian.col(static_cast<Eigen::Index>(i));
        const double derivative =
            k < 6 ? column[k] : column.head<3>().dot(rotation_jacobian(turn).col(k - 6));
        const double difference = (forward.distance_mm[i] - back.distance_mm[i]) / (2.0 * kStep);
        // Motion over distance is the angle by which the direction to the closest point turns at most. Where
        // that goes from a face to its edge within the step the turning begins at once, elsewhere it is even,
        // and the error of third order. Rounding is 1e-13 mm over the step.
        const double motion = kStep * lever, angle = motion / std::abs(here.distance_mm[i]);
        EXPECT_NEAR(derivative, difference, lever * angle) << "point " << i << ", component " << k;
        ++compared;
        even += std::abs(derivative - difference) < lever * angle * angle + 1e-8;
      }
    }
    EXPECT_GT(compared, 1000U) << from_edges;
    EXPECT_GT(static_cast<double>(even), 0.99 * static_cast<double>(compared)) << from_edges;
  }
}

TEST(ExactSurfaces, FootOfAPointLiftedAlongTheNormalIsThePoint) {
  const Part& part = coarse_blade();
  const ClosestPointTree tree(part.model);
  int checked = 0;
  for (const Vec3& p : points_on_surfaces(part, 200, Vec3::Zero())) {
    const auto here = refine_to_exact(part, tree.query(p), p);
    if (!here) continue;
    const Vec3 lifted = p + 0.05 * here->foot.normal;
    const auto foot = refine_to_exact(part, tree.query(lifted), lifted);
    if (!foot || (foot->foot.point_mm - p).norm() > 0.1) continue;  // another surface is nearer
    EXPECT_LT((foot->foot.point_mm - p).norm(), 1e-7);
    ++checked;
  }
  EXPECT_GT(checked, 150);
}

}  // namespace
}  // namespace trueblade
