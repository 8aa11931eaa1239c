// Distances and their derivatives on shapes with closed forms; the searches against the slow twin; surface
// selection and the rim.
#include "registration/correspondences.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

Correspondences find(const Part& part, const std::vector<Vec3>& points, const RigidTransform& pose,
                     const RegistrationOptions& options = {}, const StepFrame& frame = {}) {
  const RegistrationTarget target(part);
  CorrespondenceFinder finder(target, options, points, false);
  Correspondences c;
  finder.find(pose, frame, c);
  return c;
}

// Points anywhere around the origin.
std::vector<Vec3> points_around(double size_mm, int count) {
  Rng rng(1, 0, "points around");
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(size_mm * rng.normal_vector());
  return points;
}

TEST(Correspondences, DistancesToBoxFacesEdgesAndCornersAreTheClosedForm) {
  const Vec3 size(30, 20, 10);
  const Part part = shapes::box(size, 3);
  std::vector<Vec3> outside;
  for (const Vec3& p : points_around(20.0, 500))
    if ((p.array() < 0.0).any() || (p.array() > size.array()).any()) outside.push_back(p);
  const Correspondences c = find(part, outside, RigidTransform{});
  for (std::size_t i = 0; i < outside.size(); ++i) {
    const Vec3 clamped = outside[i].cwiseMax(0.0).cwiseMin(size);
    EXPECT_NEAR(c.distance_mm[i], (outside[i] - clamped).norm(), 1e-12);  // a few ulps of 60 mm
  }
}

// d(distance)/d(step) by central differences, on faces, edges and corners, away from where the closest
// feature changes.
TEST(Correspondences, JacobianIsTheDerivativeOfTheDistance) {
  const Part part = shapes::box(Vec3(30, 20, 10), 2);
  const auto points = points_around(20.0, 400);
  const StepFrame frame{Vec3(3, 5, -2), 17.0};
  RigidTransform pose = shapes::some_pose();
  pose.translation_mm = Vec3(1, 2, 3);
  const Correspondences c = find(part, points, pose, {}, frame);
  const double h = 1e-4;
  int compared = 0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    const Vec6 step = frame.unscaled(h * Vec6::Unit(k));
    const Correspondences forward =
        find(part, points, moved_about(pose, step, frame.pivot_part_mm), {}, frame);
    const Correspondences back = find(part, points, moved_about(pose, -step, frame.pivot_part_mm), {}, frame);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const ClosestPoint &f = forward.closest[i], &b = back.closest[i];
      if (f.facet != b.facet || f.feature != b.feature || c.distance_mm[i] < 0.1) continue;
      const double difference = (forward.distance_mm[i] - back.distance_mm[i]) / (2.0 * h);
      // Third derivatives of a distance are at most about (lever / distance)^2 / distance: 1e-8 * 1e3 / 6.
      EXPECT_NEAR(c.jacobian(k, static_cast<Eigen::Index>(i)), difference, 1e-5);
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000);
}

// Sliding along a tilted facet costs nothing: the residual is n . (x - c), not a vector of its components.
TEST(Correspondences, SlidingAlongATiltedFacetIsFree) {
  const Part part = shapes::plane(60, 60, 4);
  RigidTransform tilt;
  tilt.rotation = rotation_from_vector(Vec3(0.4, 0.3, 0.2));
  FacetSoup soup;
  for (std::uint32_t f = 0; f < part.model.facet_count(); ++f)
    for (const Vec3& corner : part.model.corners_mm(f)) soup.nodes_mm.push_back(tilt * corner);
  for (std::uint32_t k = 0; k < soup.nodes_mm.size(); k += 3) soup.facets.push_back({k, k + 1, k + 2});
  const Part tilted = shapes::part_of(soup, 1e-6);
  const Vec3 normal = tilt.rotation * Vec3::UnitZ(), along = tilt.rotation * Vec3(1, 2, 0).normalized();
  const Vec3 point = tilt * Vec3(1.3, 2.1, 0.5);
  const Correspondences here = find(tilted, {point}, RigidTransform{});
  const Correspondences there = find(tilted, {point + 5.0 * along}, RigidTransform{});
  EXPECT_NEAR(here.distance_mm[0], 0.5, 1e-13);
  EXPECT_NEAR(there.distance_mm[0], 0.5, 1e-13);
  const Vec3 gradient = here.jacobian.col(0).tail<3>();
  EXPECT_LT((gradient - normal).norm(), 1e-12);
  EXPECT_NEAR(gradient.dot(along), 0.0, 1e-12);
}

TEST(Correspondences, OnlySelectedSurfacesAreEligibleAndUnknownOnesAreNamed) {
  const Part part = shapes::box(Vec3(30, 20, 10), 2);
  RegistrationOptions options;
  options.surfaces = {1, 5};
  const std::vector<Vec3> points{Vec3(31, 10, 5), Vec3(-1, 10, 5), Vec3(15, 10, 11)};
  const Correspondences c = find(part, points, RigidTransform{}, options);
  EXPECT_EQ(c.eligible, (std::vector<std::uint8_t>{1, 0, 1}));
  options.surfaces = {1, 6};
  try {
    find(part, points, RigidTransform{}, options);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "surfaces names 6, but the part's surfaces are 0 to 5");
  }
}

TEST(Correspondences, RimPolicyRejectsPointsBeyondAnOpenSheet) {
  const Part part = shapes::plane(20, 20, 4);
  RegistrationOptions options;
  const std::vector<Vec3> points{Vec3(1, 2, 0.1), Vec3(11, 2, 0.1), Vec3(12, 13, 0.1)};
  EXPECT_EQ(find(part, points, RigidTransform{}, options).eligible, (std::vector<std::uint8_t>{1, 1, 1}));
  options.rejection.boundary = BoundaryPolicy::reject;
  EXPECT_EQ(find(part, points, RigidTransform{}, options).eligible, (std::vector<std::uint8_t>{1, 0, 0}));
}

TEST(Correspondences, ExactTreeWithAndWithoutCacheEqualsBruteForceWhileThePoseMoves) {
  const Part part = shapes::blade(24, 22);
  const RegistrationTarget target(part);
  const auto points = shapes::points_on(part, 300, Vec3::Zero(), 0.2, 5);
  RegistrationOptions cached, plain, brute;
  plain.closest_point.cache = CorrespondenceCache::none;
  brute.closest_point = {ClosestPointSearch::brute_force, CorrespondenceCache::none, {}, 0.0};
  CorrespondenceFinder a(target, cached, points, false), b(target, plain, points, false),
      c(target, brute, points, false);
  Correspondences ca, cb, cc;
  for (int k = 0; k < 6; ++k) {
    const RigidTransform pose =
        shapes::displaced(RigidTransform{}, 3.0 / (1 << (2 * k)), 0.05 / (1 << (2 * k)), Vec3(0, 0, 50), 6);
    a.find(pose, {}, ca);
    b.find(pose, {}, cb);
    c.find(pose, {}, cc);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(ca.closest[i].distance_mm, cc.closest[i].distance_mm, 1e-12);
      EXPECT_NEAR(cb.closest[i].distance_mm, cc.closest[i].distance_mm, 1e-12);
    }
  }
  EXPECT_GT(a.work().cache_hits, 0U);
  EXPECT_LT(a.work().cache_hits, a.work().queries);
  EXPECT_EQ(b.work().cache_hits, 0U);
}

RegistrationOptions by_node(ClosestPointSearch search, CorrespondenceCache cache, NodeStructure structure) {
  RegistrationOptions options;
  options.closest_point = {search, cache, structure, 0.0};
  return options;
}

// Figure 3: the point lies on a large facet, but the nearest node belongs to the small one beside it.
TEST(NodeSearch, WalkReachesTheClosestFacetThatTheNearestNodeDoesNotTouch) {
  FacetSoup soup;
  soup.nodes_mm = {Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(5, 10, 0), Vec3(5, -1, 0)};
  soup.facets = {{0, 1, 2}, {0, 3, 1}};
  const Part part = shapes::part_of(soup);
  const std::vector<Vec3> point{Vec3(5, 0.8, 0.1)};
  for (const NodeStructure structure : {NodeStructure::box_decomposition_tree, NodeStructure::kd_tree}) {
    const auto plain =
        find(part, point, RigidTransform{},
             by_node(ClosestPointSearch::nearest_node_facets, CorrespondenceCache::none, structure));
    const auto walk =
        find(part, point, RigidTransform{},
             by_node(ClosestPointSearch::nearest_node_walk, CorrespondenceCache::none, structure));
    EXPECT_NEAR(plain.closest[0].distance_mm, std::hypot(0.8, 0.1), 1e-15);
    EXPECT_NEAR(walk.closest[0].distance_mm, 0.1, 1e-15);
  }
}

// What the walk cannot do: cross to a shell that shares no node. The exact tree can.
TEST(NodeSearch, WalkStaysOnItsShellWhereTheExactTreeCrosses) {
  FacetSoup soup;
  soup.nodes_mm = {Vec3(-20, -20, 0), Vec3(20, -20, 0), Vec3(0, 30, 0),
                   Vec3(0, 0, 2),     Vec3(1, 0, 2),    Vec3(0, 1, 2)};
  soup.facets = {{0, 1, 2}, {3, 4, 5}};
  const Part part = shapes::part_of(soup);
  const std::vector<Vec3> point{Vec3(-1, -1, 0.5)};
  const auto walk = find(part, point, RigidTransform{},
                         by_node(ClosestPointSearch::nearest_node_walk, CorrespondenceCache::none, {}));
  EXPECT_NEAR(walk.closest[0].distance_mm, Vec3(1, 1, 1.5).norm(), 1e-14);
  EXPECT_NEAR(find(part, point, RigidTransform{}).closest[0].distance_mm, 0.5, 1e-14);
}

// The caches answer part of the queries while the points move, and what they answer is on the part: at least
// the true distance away, and mostly just that.
TEST(NodeSearch, CachesAnswerWithoutLosingTheSurface) {
  const Part part = shapes::blade(48, 44);
  const RegistrationTarget target(part);
  const auto points = shapes::points_on(part, 1000, Vec3::Zero(), 0.003, 5);
  for (const CorrespondenceCache cache : {CorrespondenceCache::published, CorrespondenceCache::five_points}) {
    const auto options = by_node(ClosestPointSearch::nearest_node_walk, cache, {});
    CorrespondenceFinder cached(target, options, points, false);
    const RegistrationOptions exactly;
    CorrespondenceFinder exact(target, exactly, points, false);
    Correspondences c, e;
    std::size_t right = 0, all = 0;
    for (int k = 0; k < 8; ++k) {
      const RigidTransform pose =
          shapes::displaced(RigidTransform{}, std::ldexp(0.5, -k), std::ldexp(0.01, -k), Vec3(0, 0, 50), 6);
      cached.find(pose, {}, c);
      exact.find(pose, {}, e);
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_GE(c.closest[i].distance_mm, e.closest[i].distance_mm - 1e-12);
        right += c.closest[i].distance_mm < e.closest[i].distance_mm + 1e-9;
        ++all;
      }
    }
    EXPECT_GT(cached.work().cache_hits, 0U) << to_string(cache);
    EXPECT_LT(cached.work().cache_hits, cached.work().queries) << to_string(cache);
    EXPECT_GT(static_cast<double>(right), 0.8 * static_cast<double>(all)) << to_string(cache);
  }
}

}  // namespace
}  // namespace trueblade
