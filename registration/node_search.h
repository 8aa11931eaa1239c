// The paper's closest point (section 3.1): the approximate nearest node, the walk over neighbour facets from
// there to a local minimum, and the facet cached from the last iteration. Fast to build, but not exact: the
// walk ends in a local minimum and cannot cross to a shell that shares no node. Part frame, mm.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/closest_point_tree.h"
#include "registration/options.h"

namespace trueblade {

// Const functions may run from any number of threads. Keeps a reference: the model must outlive it.
class NodeSearch {
 public:
  explicit NodeSearch(const FacetModel& model);
  ~NodeSearch();

  // P3: the nodes.size() nearest nodes, nearest first, each within (1 + epsilon) of the true one's distance
  // (Eq. 1). Precondition: at most as many as the model has nodes.
  void nearest_nodes(const Vec3& query_mm, NodeStructure structure, double epsilon,
                     std::span<std::uint32_t> nodes) const;

  // The closest point on the facets around a node.
  ClosestPoint on_facets_of(std::uint32_t node, const Vec3& query_mm, ClosestPointWork& work) const;

  // P4: goes from facet to the neighbour facet (sharing a node) of least distance, until no neighbour is
  // closer or the projection falls inside the facet.
  ClosestPoint walk(ClosestPoint start, const Vec3& query_mm, ClosestPointWork& work) const;

  // P5: the closest point on the cached facet or its immediate neighbours where that is a local minimum in
  // the sense of `walk`; none otherwise.
  std::optional<ClosestPoint> from_cached_facet(std::uint32_t facet, const Vec3& query_mm,
                                                ClosestPointWork& work) const;

  std::size_t node_count() const { return model_.node_count(); }
  double distance_to_node_mm(std::uint32_t node, const Vec3& query_mm) const;

 private:
  void improve(ClosestPoint& best, std::uint32_t facet, const Vec3& query_mm, ClosestPointWork& work) const;
  // The best of `best` and the facets that share a node with `facet`.
  ClosestPoint best_neighbour(ClosestPoint best, std::uint32_t facet, const Vec3& query_mm,
                              ClosestPointWork& work) const;
  std::span<const std::uint32_t> facets_of(std::uint32_t node) const;

  const FacetModel& model_;
  std::vector<std::uint32_t> first_facet_,
      node_facets_;  // Table 1: node -> neighbour facets, one after the other
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace trueblade
