#include "geometry/node_walk.h"

#include <algorithm>
#include <array>

namespace trueblade {

NodeWalk::NodeWalk(const FacetModel& model)
    : model_(model), first_facet_(model.node_count() + 1, 0), facet_(3 * model.facet_count()) {
  // Counting sort of the corners by node.
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet)
    for (const std::uint32_t node : model.facet_nodes(facet)) ++first_facet_[node + 1];
  for (std::size_t n = 1; n < first_facet_.size(); ++n) first_facet_[n] += first_facet_[n - 1];
  std::vector<std::uint32_t> next(first_facet_.begin(), first_facet_.end() - 1);
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet)
    for (const std::uint32_t node : model.facet_nodes(facet)) facet_[next[node]++] = facet;
}

std::span<const std::uint32_t> NodeWalk::facets_of(std::uint32_t node) const {
  return std::span(facet_).subspan(first_facet_[node], first_facet_[node + 1] - first_facet_[node]);
}

void NodeWalk::try_facet(std::uint32_t facet, const Vec3& query_mm, ClosestPoint& closest,
                         ClosestPointWork& work) const {
  const auto [a, b, c] = model_.corners_mm(facet);
  const FacetPoint foot = closest_point_on_facet(a, b, c, query_mm);
  const double distance = (query_mm - foot.point_mm).norm();
  ++work.facets_tested;
  if (distance < closest.distance_mm) closest = {foot.point_mm, distance, facet, foot.feature};
}

// Moves to the closest of the facets that share a node with the present one; false when none is closer.
bool NodeWalk::step_to_neighbour(const Vec3& query_mm, ClosestPoint& closest, ClosestPointWork& work) const {
  const std::uint32_t from = closest.facet;
  const std::array<std::uint32_t, 3>& nodes = model_.facet_nodes(from);
  for (auto corner = nodes.begin(); corner != nodes.end(); ++corner)
    for (const std::uint32_t facet : facets_of(*corner)) {
      // A facet across an edge was met at the edge's first node already.
      const auto& others = model_.facet_nodes(facet);
      const bool met = std::any_of(nodes.begin(), corner, [&](std::uint32_t node) {
        return std::find(others.begin(), others.end(), node) != others.end();
      });
      if (facet != from && !met) try_facet(facet, query_mm, closest, work);
    }
  return closest.facet != from;
}

// Otherwise `closest` has moved on to a neighbour.
bool NodeWalk::is_local_minimum(const Vec3& query_mm, ClosestPoint& closest, ClosestPointWork& work) const {
  return closest.feature == FacetFeature::interior || !step_to_neighbour(query_mm, closest, work);
}

ClosestPoint NodeWalk::on_facets_of(std::uint32_t node, const Vec3& query_mm, ClosestPointWork& work) const {
  ClosestPoint closest;
  for (const std::uint32_t facet : facets_of(node)) try_facet(facet, query_mm, closest, work);
  return closest;
}

ClosestPoint NodeWalk::walk(ClosestPoint start, const Vec3& query_mm, ClosestPointWork& work) const {
  // Every step lowers the distance, so that no facet is met twice.
  while (!is_local_minimum(query_mm, start, work)) {
  }
  return start;
}

std::optional<ClosestPoint> NodeWalk::from_cached_facet(std::uint32_t facet, const Vec3& query_mm,
                                                        ClosestPointWork& work) const {
  ClosestPoint closest;
  try_facet(facet, query_mm, closest, work);
  if (is_local_minimum(query_mm, closest, work) || is_local_minimum(query_mm, closest, work)) return closest;
  return std::nullopt;
}

}  // namespace trueblade
