// The paper's search: what it promises (a local minimum), what it does not (the closest point), and the
// caches.
#include "geometry/node_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/node_tree.h"
#include "tests/geometry/search_shapes.h"

namespace trueblade {
namespace {

ClosestPoint from_nearest_node(const FacetModel& model, const NodeTree& tree, const Vec3& query,
                               double epsilon) {
  ClosestPointWork work;
  std::uint32_t node = 0;
  tree.nearest(query, epsilon, {&node, 1}, work);
  return NodeWalk(model).on_facets_of(node, query, work);
}

ClosestPoint walked(const FacetModel& model, const ClosestPoint& start, const Vec3& query) {
  ClosestPointWork work;
  return NodeWalk(model).walk(start, query, work);
}

// Figure 3: the query lies on a long facet (distance zero), but its nearest node belongs to another facet,
// which ends short of it.
//
//   nodes 0 = (0,0,0), 1 = (100,0,0), 2 = (50,60,0): the long facet 0; the query (50,20,0) lies in its
//   middle,
//         20 mm from its edge 0-1 and 40 mm or more from its nodes
//   node 3 = (50,-30,0): facet 1 = (1,0,3), across the edge 0-1
//   node 4 = (48,15,1): the tip of a flap, facet 2 = (3,0,4), across the edge 0-3; the query lies beyond the
//   tip,
//         sqrt(2^2 + 5^2 + 1^2) mm away
FacetModel figure_3() {
  FacetSoup soup;
  soup.nodes_mm = {{0, 0, 0}, {100, 0, 0}, {50, 60, 0}, {50, -30, 0}, {48, 15, 1}};
  soup.facets = {{0, 1, 2}, {1, 0, 3}, {3, 0, 4}};
  return build_facet_model(soup, 0.0).model;
}

TEST(NodeWalk, Figure3PlainNearestNodeFailsAndTheWalkPasses) {
  const FacetModel model = figure_3();
  ASSERT_EQ(model.facet_count(), 3U);
  const Vec3 query(50.0, 20.0, 0.0);
  for (const NodeTreeKind kind : {NodeTreeKind::box_decomposition, NodeTreeKind::kd}) {
    const ClosestPoint plain = from_nearest_node(model, NodeTree(model, kind), query, 0.0);
    EXPECT_EQ(plain.distance_mm, std::sqrt(30.0));
    EXPECT_EQ(plain.facet, 2U);
    const ClosestPoint closest = walked(model, plain, query);
    EXPECT_EQ(closest.distance_mm, 0.0);
    EXPECT_EQ(closest.facet, 0U);
  }
}

// The published walk stops where the projection falls inside a facet, be another facet closer or not: with
// the flap's tip beyond the query and 1 mm above it, the walk stays on the flap.
TEST(NodeWalk, StopsInsideAFacetAsPublished) {
  FacetSoup soup;
  soup.nodes_mm = {{0, 0, 0}, {100, 0, 0}, {50, 60, 0}, {50, -30, 0}, {50, 25, 1}};
  soup.facets = {{0, 1, 2}, {1, 0, 3}, {3, 0, 4}};
  const FacetModel model = build_facet_model(soup, 0.0).model;
  const Vec3 query(49.0, 20.0, 0.0);
  const ClosestPoint closest =
      walked(model, from_nearest_node(model, NodeTree(model, NodeTreeKind::kd), query, 0.0), query);
  EXPECT_EQ(closest.feature, FacetFeature::interior);
  EXPECT_EQ(closest.facet, 2U);
  EXPECT_EQ(closest_point_brute_force(model, query).distance_mm, 0.0);
}

// Close to a smooth closed surface the local minimum is the closest point: 0.5 mm from a sphere of 40 mm.
TEST(NodeWalk, IsRightCloseToASmoothSurface) {
  const FacetModel model = build_facet_model(shapes::sphere(40.0, 4), 0.0).model;
  const NodeTree tree(model, NodeTreeKind::box_decomposition);
  Rng rng(31, 0, "sphere");
  for (int i = 0; i < 500; ++i) {
    const Vec3 query = (40.0 + 0.5 * rng.normal()) * rng.normal_vector().normalized();
    const ClosestPoint closest = walked(model, from_nearest_node(model, tree, query, 0.1), query);
    // Both are computed by closest_point_on_facet: the same bits, of whichever facet.
    EXPECT_EQ(closest.distance_mm, closest_point_brute_force(model, query).distance_mm);
  }
}

// It never reports less than the truth, and where its foot is not inside a facet no neighbour is closer.
TEST(NodeWalk, EndsInALocalMinimum) {
  for (const auto& [name, model] : shapes::search_models()) {
    SCOPED_TRACE(name);
    const NodeTree tree(model, NodeTreeKind::kd);
    for (const Vec3& query : shapes::search_queries(model, 200, 32)) {
      const ClosestPoint plain = from_nearest_node(model, tree, query, 0.5);
      const ClosestPoint closest = walked(model, plain, query);
      EXPECT_LE(closest.distance_mm, plain.distance_mm);
      EXPECT_GE(closest.distance_mm, closest_point_brute_force(model, query).distance_mm);
      if (closest.feature == FacetFeature::interior) continue;
      const auto& nodes = model.facet_nodes(closest.facet);
      for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
        const auto& others = model.facet_nodes(facet);
        if (std::find_first_of(others.begin(), others.end(), nodes.begin(), nodes.end()) == others.end())
          continue;
        const auto [a, b, c] = model.corners_mm(facet);
        EXPECT_GE((closest_point_on_facet(a, b, c, query).point_mm - query).norm(), closest.distance_mm);
      }
    }
  }
}

// Where shells share no node the walk cannot cross: over a long facet of one sheet, the nearest node belongs
// to a finer sheet 1 mm behind it. The exact tree is right there.
TEST(NodeWalk, CannotCrossToAnotherShell) {
  FacetSoup soup;
  soup.nodes_mm = {{-100, -100, 0}, {200, -100, 0}, {50, 300, 0}};
  soup.facets = {{0, 1, 2}};
  FacetSoup behind = shapes::sheet(20, 20);
  for (Vec3& node : behind.nodes_mm) node.z() = -1.0;
  shapes::append(soup, behind);
  const FacetModel model = build_facet_model(soup, 0.0).model;
  const Vec3 query(10.3, 10.4, 0.25);
  const NodeTree tree(model, NodeTreeKind::kd);
  EXPECT_EQ(walked(model, from_nearest_node(model, tree, query, 0.0), query).distance_mm, 1.25);
  EXPECT_EQ(ClosestPointTree(model).query(query).distance_mm, 0.25);
}

// P5. With small motions every point is answered by its facet or a neighbour, and every answer is a local
// minimum: on a smooth surface, the closest point. After a large motion the cache says that it cannot answer.
TEST(NodeWalk, TheCachedFacetAnswersNearConvergence) {
  const FacetModel model = build_facet_model(shapes::sphere(40.0, 4), 0.0).model;
  const NodeWalk walk(model);
  Rng rng(33, 0, "cache");
  ClosestPointWork work;
  int answered_after_turn = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 query = (40.0 + 0.1 * rng.normal()) * rng.normal_vector().normalized();
    const std::uint32_t cached = closest_point_brute_force(model, query).facet;
    // 0.02 mm against facets of 2.5 mm: the foot stays within the facet or its neighbours.
    const Vec3 moved = query + Vec3(0.01, 0.02, -0.01);
    const std::optional<ClosestPoint> closest = walk.from_cached_facet(cached, moved, work);
    ASSERT_TRUE(closest);
    EXPECT_EQ(closest->distance_mm, closest_point_brute_force(model, moved).distance_mm);
    // A turn by a right angle takes a point many facets away, unless it is near the axis.
    const Vec3 turned(-query.y(), query.x(), query.z());
    const std::optional<ClosestPoint> far = walk.from_cached_facet(cached, turned, work);
    if (!far) continue;
    ++answered_after_turn;
    EXPECT_EQ(far->distance_mm, closest_point_brute_force(model, turned).distance_mm);
  }
  EXPECT_LT(answered_after_turn, 10);
}

}  // namespace
}  // namespace trueblade
