// Closest point on one facet: by construction in each Voronoi region, against dense sampling, and on
// triangles that are thin, flat or no triangles at all.
#include "geometry/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/random.h"
#include "geometry/rigid_transform.h"
#include "geometry/triangle.h"
#include "tests/geometry/shapes.h"

namespace trueblade {
namespace {

constexpr double kUlp = 0x1p-52;
constexpr FacetFeature kEdges[] = {FacetFeature::edge_0, FacetFeature::edge_1, FacetFeature::edge_2};
constexpr FacetFeature kNodes[] = {FacetFeature::node_0, FacetFeature::node_1, FacetFeature::node_2};

using Triangle = std::array<Vec3, 3>;
FacetPoint closest_to(const Triangle& t, const Vec3& query) {
  return closest_point_on_facet(t[0], t[1], t[2], query);
}

Triangle random_triangle(Rng& rng) {
  return {10.0 * rng.normal_vector(), 10.0 * rng.normal_vector(), 10.0 * rng.normal_vector()};
}

// A query is built from its known foot point: any point of the facet plus a vector of the cone of directions
// whose closest point is that foot (the normal cone of the feature). The answer must be the foot, to the
// rounding of the construction: coordinates of a few ten mm, some ten operations, and a division by the sine
// of the facet's angles.
TEST(ClosestPointOnFacet, FindsTheFootItWasBuiltFrom) {
  Rng rng(1, 0, "regions");
  for (int i = 0; i < 2000; ++i) {
    const Triangle t = random_triangle(rng);
    const Vec3 normal = triangle_area_vector(t[0], t[1], t[2]).normalized();
    double least_sine = 1.0;
    for (int k = 0; k < 3; ++k)
      least_sine =
          std::min(least_sine,
                   (t[(k + 1) % 3] - t[k]).normalized().cross((t[(k + 2) % 3] - t[k]).normalized()).norm());
    const double rounding_mm = 64.0 * kUlp * 50.0 / least_sine;
    const double height_mm = 10.0 * rng.normal();

    const double u = 0.05 + 0.4 * rng.uniform(), v = 0.05 + 0.4 * rng.uniform();
    const Vec3 inside = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
    const FacetPoint face = closest_to(t, inside + height_mm * normal);
    EXPECT_EQ(face.feature, FacetFeature::interior);
    EXPECT_NEAR((face.point_mm - inside).norm(), 0.0, rounding_mm);

    for (int k = 0; k < 3; ++k) {
      const Vec3 along = t[(k + 1) % 3] - t[k];
      const Vec3 outward = along.cross(normal).normalized();
      const Vec3 on_edge = t[k] + (0.05 + 0.9 * rng.uniform()) * along;
      const FacetPoint edge =
          closest_to(t, on_edge + height_mm * normal + (0.1 + 5.0 * rng.uniform()) * outward);
      EXPECT_EQ(edge.feature, kEdges[k]);
      EXPECT_NEAR((edge.point_mm - on_edge).norm(), 0.0, rounding_mm);

      // At a node the cone lies between the outward directions of its two edges.
      const Vec3 outward_before = (t[k] - t[(k + 2) % 3]).cross(normal).normalized();
      const double a = 0.1 + rng.uniform(), b = 0.1 + rng.uniform();
      const FacetPoint node =
          closest_to(t, t[k] + height_mm * normal + 3.0 * (a * outward + b * outward_before));
      EXPECT_EQ(node.feature, kNodes[k]);
      EXPECT_EQ(node.point_mm, t[k]);
    }
  }
}

// No point of a dense grid on the facet is closer, and the answer is not closer than the grid's pitch allows.
TEST(ClosestPointOnFacet, IsNoFartherThanAnySample) {
  Rng rng(2, 0, "samples");
  for (int i = 0; i < 200; ++i) {
    const Triangle t = random_triangle(rng);
    const Vec3 query = 15.0 * rng.normal_vector();
    const double distance_mm = (closest_to(t, query).point_mm - query).norm();
    constexpr int kSteps = 100;
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (int u = 0; u <= kSteps; ++u)
      for (int v = 0; u + v <= kSteps; ++v) {
        const Vec3 sample = t[0] + (u * (t[1] - t[0]) + v * (t[2] - t[0])) / kSteps;
        nearest_mm = std::min(nearest_mm, (sample - query).norm());
      }
    const double pitch_mm = ((t[1] - t[0]).norm() + (t[2] - t[0]).norm()) / kSteps;
    EXPECT_LE(distance_mm, nearest_mm + 32.0 * kUlp * 50.0);
    EXPECT_GE(distance_mm, nearest_mm - pitch_mm);
  }
}

TEST(ClosestPointOnFacet, DoesNotDependOnCornerOrder) {
  Rng rng(3, 0, "order");
  for (int i = 0; i < 500; ++i) {
    const Triangle t = random_triangle(rng);
    const Vec3 query = 15.0 * rng.normal_vector();
    const double distance_mm = (closest_to(t, query).point_mm - query).norm();
    for (const Triangle& other : {Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[1], t[0]}})
      EXPECT_NEAR((closest_to(other, query).point_mm - query).norm(), distance_mm, 64.0 * kUlp * 50.0);
  }
}

// Thin triangles: the height falls to nothing over an edge of 10 mm, the nodes on a line, in pairs or all in
// one place. The distance must be that of the best of the three edges, up to what the facet's own height can
// add.
TEST(ClosestPointOnFacet, ThinTrianglesDegradeGracefully) {
  Rng rng(4, 0, "thin");
  for (const double height_mm : {1e-3, 1e-6, 1e-7, 1e-8, 1e-10, 1e-13, 1e-16, 0.0}) {
    for (int i = 0; i < 200; ++i) {
      const RigidTransform part_from_plane{rotation_from_vector(2.0 * rng.normal_vector()),
                                           10.0 * rng.normal_vector()};
      // Needles (the short edge at one end) and caps (the third node near the middle of the long edge).
      const double x = i % 2 == 0 ? 10.0 : 10.0 * rng.uniform();
      const Triangle t{part_from_plane * Vec3(0, 0, 0), part_from_plane * Vec3(10.0, 0, 0),
                       part_from_plane * Vec3(x, height_mm, 0)};
      const Vec3 foot(10.0 * rng.uniform(), 0.0, 0.0);
      const Vec3 away =
          std::pow(10.0, -4.0 * rng.uniform()) * Vec3(0.0, rng.normal(), rng.normal()).normalized();
      const FacetPoint closest = closest_to(t, part_from_plane * Vec3(foot + away));
      // The true distance lies between |away| - height and |away|. Rounding: coordinates of 40 mm; and the
      // plane of a triangle is used down to height / edge = 1.5e-8, with a normal good to 2^-52 * 40 / 10
      // / 1.5e-8 = 6e-8 rad, which at 1 mm moves the foot point by 6e-8 mm; its effect on the distance is
      // second order unless the query is as near.
      const double distance_mm = (closest.point_mm - part_from_plane * Vec3(foot + away)).norm();
      EXPECT_LE(distance_mm, away.norm() + 64.0 * kUlp * 40.0) << height_mm << " " << i;
      EXPECT_GE(distance_mm, away.norm() - height_mm - 1e-7) << height_mm << " " << i;
    }
  }
}

TEST(ClosestPointOnFacet, CollapsedTrianglesAreSegmentsOrPoints) {
  const Vec3 a(1, 2, 3), b(4, 2, 3);
  EXPECT_EQ(closest_point_on_facet(a, a, a, {9, 9, 9}).point_mm, a);
  for (const Triangle& t : {Triangle{a, a, b}, Triangle{a, b, a}, Triangle{b, a, a}}) {
    EXPECT_EQ(closest_to(t, {2.0, 7.0, 3.0}).point_mm, Vec3(2, 2, 3));
    EXPECT_EQ(closest_to(t, {9.0, 7.0, 3.0}).point_mm, b);
    EXPECT_EQ(closest_to(t, {-9.0, 7.0, 3.0}).point_mm, a);
  }
}

TEST(ClosestPointOnFacet, PointsOfTheFacetAreTheirOwnFeet) {
  const Triangle t{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  EXPECT_EQ(closest_to(t, {1, 1, 0}).feature, FacetFeature::interior);
  EXPECT_EQ(closest_to(t, {2, 0, 0}).feature, FacetFeature::edge_0);
  EXPECT_EQ(closest_to(t, {2, 2, 0}).feature, FacetFeature::edge_1);
  EXPECT_EQ(closest_to(t, {0, 2, 0}).feature, FacetFeature::edge_2);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(closest_to(t, t[k]).feature, kNodes[k]);
    EXPECT_EQ(closest_to(t, t[k]).point_mm, t[k]);
  }
}

TEST(ClosestPointBruteForce, KnowsTheSphere) {
  // The distance to a fine sphere is | |q| - r | up to the sagitta: edge angle at most 0.08 rad, below 0.08^2
  // / 6 r.
  const FacetModel model = build_facet_model(shapes::sphere(10.0, 4), 0.0).model;
  Rng rng(5, 0, "sphere");
  for (int i = 0; i < 50; ++i) {
    const Vec3 query = 12.0 * rng.normal_vector();
    const ClosestPoint closest = closest_point_brute_force(model, query);
    EXPECT_NEAR(closest.distance_mm, std::abs(query.norm() - 10.0), 0.0011 * 10.0);
    EXPECT_EQ(closest.distance_mm, (closest.point_mm - query).norm());
    const auto [a, b, c] = model.corners_mm(closest.facet);
    EXPECT_EQ(closest_point_on_facet(a, b, c, query).point_mm, closest.point_mm);
  }
}

}  // namespace
}  // namespace trueblade
