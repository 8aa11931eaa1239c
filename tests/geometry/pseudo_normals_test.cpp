// Sign of the distance: closed forms of which side is inside, where the normal of the nearest facet alone
// says wrong, and at places where the surface is no manifold.
#include "geometry/pseudo_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/random.h"
#include "geometry/rigid_transform.h"
#include "tests/geometry/shapes.h"

namespace trueblade {
namespace {

// Compares the sign with `is_inside` for random queries; returns in how many cases the normal of the closest
// facet alone would have said otherwise.
template <class IsInside>
int check_signs(const FacetModel& model, const IsInside& is_inside, double spread_mm, const Vec3& centre_mm) {
  const PseudoNormals normals(model);
  Rng rng(1, 0, "signs");
  int naive_wrong = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 query = centre_mm + spread_mm * rng.normal_vector();
    ClosestPoint closest = closest_point_brute_force(model, query);
    if (closest.distance_mm < 1e-9) continue;  // on the surface to rounding: either sign will do
    const double expected = is_inside(query) ? -1.0 : 1.0;
    EXPECT_EQ(normals.sign(closest, query), expected) << query.transpose();
    EXPECT_EQ(normals.signed_distance_mm(closest, query), expected * closest.distance_mm);
    closest.feature = FacetFeature::interior;
    naive_wrong += normals.sign(closest, query) != expected;
  }
  return naive_wrong;
}

TEST(PseudoNormals, CubeIsRightEverywhere) {
  const auto inside = [](const Vec3& q) { return q.minCoeff() > 0.0 && q.maxCoeff() < 2.0; };
  check_signs(build_facet_model(shapes::cube(2.0), 0.0).model, inside, 1.5, Vec3::Ones());
}

// A sharp tetrahedron: seen from beyond its apex, some facets that hold the apex face away from the query.
TEST(PseudoNormals, SharpApexIsRightWhereTheNearestFacetIsWrong) {
  FacetSoup soup;
  soup.nodes_mm = {{0, 0, 0}, {10, 1, 0}, {10, -1, 1}, {10, -1, -1}};
  soup.facets = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  ASSERT_TRUE(build.report.closed);
  ASSERT_GT(build.model.volume_mm3(), 0.0);
  const auto inside = [&](const Vec3& q) {
    for (std::uint32_t facet = 0; facet < 4; ++facet)
      if (build.model.facet_normal(facet).dot(q - build.model.corners_mm(facet)[0]) > 0.0) return false;
    return true;
  };
  EXPECT_GT(check_signs(build.model, inside, 3.0, {2.0, 0.0, 0.0}), 100);
}

// The L-shaped prism has a concave edge and nodes with a saddle; inside is the cube [0, 2]^3 less a quarter.
TEST(PseudoNormals, ConcaveBodyIsRightEverywhere) {
  FacetSoup soup;
  const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 2.0})
    for (const auto& [x, y] : outline) soup.nodes_mm.push_back({x, y, z});
  soup.facets = {{0, 3, 1}, {1, 3, 2}, {0, 5, 3}, {3, 5, 4}, {6, 7, 9}, {7, 8, 9}, {6, 9, 11}, {9, 10, 11}};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t next = (i + 1) % 6;
    soup.facets.push_back({i, next, next + 6});
    soup.facets.push_back({i, next + 6, i + 6});
  }
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  ASSERT_TRUE(build.report.closed);
  ASSERT_EQ(build.model.volume_mm3(), 6.0);
  const auto inside = [](const Vec3& q) {
    return q.minCoeff() > 0.0 && q.maxCoeff() < 2.0 && !(q.x() > 1.0 && q.y() > 1.0);
  };
  check_signs(build.model, inside, 1.2, Vec3::Ones());
}

// Two bodies that touch in a node, and two that share an edge: there the nodes are doubled, the sign must not
// notice.
TEST(PseudoNormals, TouchingBodiesAreRightEverywhere) {
  const auto in_cube = [](const Vec3& q, const Vec3& low) {
    return (q - low).minCoeff() > 0.0 && (q - low).maxCoeff() < 1.0;
  };
  for (const Vec3& offset : {Vec3(1, 1, 1), Vec3(1, 1, 0)}) {
    FacetSoup soup = shapes::cube(1.0);
    shapes::append(soup, shapes::cube(1.0, offset));
    const FacetModelBuild build = build_facet_model(soup, 0.0);
    ASSERT_EQ(build.model.facet_count(), 24u);
    const auto inside = [&](const Vec3& q) { return in_cube(q, Vec3::Zero()) || in_cube(q, offset); };
    check_signs(build.model, inside, 0.5, Vec3(1.0, 1.0, 0.75));
  }
}

// A pyramid-shaped pit whose tip touches the outer node of the body around it: at the shared node only the
// sum over both fans, the pit's and the outside's, has the right sign. Nested pyramids with a common apex,
// open below, closed by a ring.
TEST(PseudoNormals, NestedApexesInOneNodeAreRight) {
  FacetSoup soup;
  soup.nodes_mm.push_back({0, 0, 4});
  for (const double half : {2.0, 1.0})
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      soup.nodes_mm.push_back({half * x, half * y, 0});
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t next = (i + 1) % 4;
    soup.facets.push_back({0, 1 + i, 1 + next});  // outside
    soup.facets.push_back({0, 5 + next, 5 + i});  // pit
    soup.facets.push_back({1 + i, 5 + i, 5 + next});
    soup.facets.push_back({1 + i, 5 + next, 1 + next});
  }
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  ASSERT_TRUE(build.report.closed);
  ASSERT_NEAR(build.model.volume_mm3(), 4.0 * (16.0 - 4.0) / 3.0, 1e-12);
  const auto in_pyramid = [](const Vec3& q, double half) {
    return q.z() > 0.0 && std::max(std::abs(q.x()), std::abs(q.y())) < half * (4.0 - q.z()) / 4.0;
  };
  const auto inside = [&](const Vec3& q) { return in_pyramid(q, 2.0) && !in_pyramid(q, 1.0); };
  check_signs(build.model, inside, 1.0, {0.0, 0.0, 3.0});
}

TEST(PseudoNormals, SphereSignsFollowTheRadius) {
  const FacetModel model = build_facet_model(shapes::sphere(5.0, 1), 0.0).model;
  // Between the inscribed (0.93 at the middle of a facet of 0.55 rad edges) and the circumscribed sphere
  // either may hold.
  const auto inside = [&](const Vec3& q) {
    for (std::uint32_t facet = 0; facet < model.facet_count();
         ++facet)  // convex: inside is behind all facets
      if (model.facet_normal(facet).dot(q - model.corners_mm(facet)[0]) > 0.0) return false;
    return true;
  };
  check_signs(model, inside, 4.0, Vec3::Zero());
}

TEST(PseudoNormals, NormalsOfTheCubeAreKnown) {
  const FacetModel model = build_facet_model(shapes::cube(1.0), 0.0).model;
  const PseudoNormals normals(model);
  for (const Vec3& outward :
       {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 1, 0), Vec3(-1, 0, 1), Vec3(1, 1, 1), Vec3(-1, 1, -1)}) {
    const ClosestPoint closest = closest_point_brute_force(model, Vec3(0.5, 0.47, 0.52) + 3.0 * outward);
    // Angle weights make the node normals independent of how the squares are cut: exactly the diagonals.
    EXPECT_NEAR((normals.normal(closest) - outward.normalized()).norm(), 0.0, 8.0 * 0x1p-52);
  }
}

TEST(PseudoNormals, BoundaryIsTheRimAlone) {
  const FacetModel model = build_facet_model(shapes::sheet(4, 4), 0.0).model;
  const PseudoNormals normals(model);
  const auto on_boundary = [&](const Vec3& query) {
    return normals.on_boundary(closest_point_brute_force(model, query));
  };
  EXPECT_FALSE(on_boundary({1.3, 1.2, 1.0}));        // a facet
  EXPECT_FALSE(on_boundary({1.5, 2.0, 1.0}));        // an inner edge
  EXPECT_FALSE(on_boundary({2.0, 2.0, 1.0}));        // an inner node
  EXPECT_TRUE(on_boundary({1.5, -3.0, 1.0}));        // a rim edge
  EXPECT_TRUE(on_boundary({-3.0, -3.0, 1.0}));       // a rim node
  EXPECT_FALSE(on_boundary({0.0 + 0.5, 0.5, 1.0}));  // the diagonal from a rim node to an inner one

  // Seams of a doubled node or edge are no rim.
  FacetSoup touching = shapes::cube(1.0);
  shapes::append(touching, shapes::cube(1.0, Vec3(1, 1, 0)));
  const FacetModel cubes = build_facet_model(touching, 0.0).model;
  const PseudoNormals cube_normals(cubes);
  for (std::uint32_t facet = 0; facet < cubes.facet_count(); ++facet)
    for (const FacetFeature feature : {FacetFeature::edge_0, FacetFeature::edge_1, FacetFeature::edge_2,
                                       FacetFeature::node_0, FacetFeature::node_1, FacetFeature::node_2})
      EXPECT_FALSE(cube_normals.on_boundary({Vec3::Zero(), 0.0, facet, feature}));
}

}  // namespace
}  // namespace trueblade
