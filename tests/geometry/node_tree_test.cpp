// Approximate nearest node: Eq. 1 against every node, for both trees, on nodes that cluster as they like.
#include "geometry/node_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/geometry/search_shapes.h"

namespace trueblade {
namespace {

// Clusters within clusters, each a thousandth of the last: a k-d tree gets deep on them.
FacetModel clustered_model() {
  FacetSoup soup;
  Rng rng(3, 0, "clusters");
  for (double size = 100.0; size > 1e-9; size *= 1e-3)
    for (int i = 0; i < 300; ++i) {
      const auto first = static_cast<std::uint32_t>(soup.nodes_mm.size());
      for (int k = 0; k < 3; ++k) soup.nodes_mm.push_back(size * rng.normal_vector());
      soup.facets.push_back({first, first + 1, first + 2});
    }
  return build_facet_model(soup, 0.0).model;
}

std::vector<shapes::NamedModel> models() {
  std::vector<shapes::NamedModel> models = shapes::search_models();
  models.push_back({"clusters", clustered_model()});
  return models;
}

double distance_to_node(const FacetModel& model, std::uint32_t node, const Vec3& query) {
  return (model.node_mm(node) - query).norm();
}

std::vector<double> sorted_distances(const FacetModel& model, const Vec3& query) {
  std::vector<double> distances;
  for (std::uint32_t node = 0; node < model.node_count(); ++node)
    distances.push_back(distance_to_node(model, node, query));
  std::sort(distances.begin(), distances.end());
  return distances;
}

std::uint32_t nearest_node(const NodeTree& tree, const Vec3& query, double epsilon) {
  std::uint32_t node = kNoFacet;
  ClosestPointWork work;
  tree.nearest(query, epsilon, {&node, 1}, work);
  return node;
}

TEST(NodeTree, KeepsTheBoundOfTheRelativeError) {
  for (const auto& [name, model] : models())
    for (const NodeTreeKind kind : {NodeTreeKind::box_decomposition, NodeTreeKind::kd}) {
      SCOPED_TRACE(name);
      const NodeTree tree(model, kind);
      for (const Vec3& query : shapes::search_queries(model, 100, 21)) {
        const double nearest = sorted_distances(model, query)[0];
        for (const double epsilon : {0.0, 0.1, 1.0, 10.0}) {
          const std::uint32_t node = nearest_node(tree, query, epsilon);
          ASSERT_LT(node, model.node_count());
          // Two roundings of a squared distance and the square root: 4 ulps.
          EXPECT_LE(distance_to_node(model, node, query), (1.0 + epsilon) * nearest * (1.0 + 4.0 * 0x1p-52));
        }
      }
    }
}

TEST(NodeTree, ALargerErrorCostsLess) {
  const FacetModel model = build_facet_model(shapes::sphere(40.0, 5), 0.0).model;
  for (const NodeTreeKind kind : {NodeTreeKind::box_decomposition, NodeTreeKind::kd}) {
    const NodeTree tree(model, kind);
    ClosestPointWork exact, approximate;
    std::uint32_t node = 0;
    for (const Vec3& query : shapes::search_queries(model, 400, 22)) {
      tree.nearest(query, 0.0, {&node, 1}, exact);
      tree.nearest(query, 1.0, {&node, 1}, approximate);
    }
    EXPECT_LT(approximate.boxes_tested, exact.boxes_tested);
    EXPECT_LT(exact.boxes_tested, 400 * model.node_count() / 10);  // it is a search, not a list
  }
}

// A step of the box decomposition leaves at most two thirds of the nodes on either side, so that n nodes in
// leaves of 4 are log(n / 4) / log(3/2) steps deep at most, rounded up, and one cell more.
TEST(NodeTree, TheBoxDecompositionIsBalancedOnAnyNodes) {
  for (const auto& [name, model] : models()) {
    SCOPED_TRACE(name);
    const double steps =
        std::log(std::max(1.0, static_cast<double>(model.node_count()) / 4.0)) / std::log(1.5);
    EXPECT_LE(NodeTree(model, NodeTreeKind::box_decomposition).depth(), std::ceil(steps) + 1.0);
  }
}

TEST(NodeTree, SeveralNearest) {
  for (const auto& [name, model] : models())
    for (const NodeTreeKind kind : {NodeTreeKind::box_decomposition, NodeTreeKind::kd}) {
      SCOPED_TRACE(name);
      const NodeTree tree(model, kind);
      for (const Vec3& query : shapes::search_queries(model, 50, 23)) {
        const std::vector<double> distances = sorted_distances(model, query);
        std::vector<std::uint32_t> nodes(std::min<std::size_t>(5, model.node_count()));
        ClosestPointWork work;
        tree.nearest(query, 0.0, nodes, work);
        for (std::size_t k = 0; k < nodes.size(); ++k)
          EXPECT_NEAR(distance_to_node(model, nodes[k], query), distances[k], 4.0 * 0x1p-52 * distances[k]);
        EXPECT_EQ(std::set<std::uint32_t>(nodes.begin(), nodes.end()).size(), nodes.size());
        // What an approximate list leaves out is not nearer than its last over (1 + epsilon).
        tree.nearest(query, 0.5, nodes, work);
        for (std::uint32_t node = 0; node < model.node_count(); ++node) {
          if (std::find(nodes.begin(), nodes.end(), node) != nodes.end()) continue;
          EXPECT_GE(distance_to_node(model, node, query) * (1.0 + 4.0 * 0x1p-52),
                    distance_to_node(model, nodes.back(), query) / 1.5);
        }
      }
    }
}

}  // namespace
}  // namespace trueblade
