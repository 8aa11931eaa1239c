// The paper's search from a node to the closest facet (section 3.1): a walk over the neighbouring facets in
// the direction of the least distance to a local minimum (P4), and the closest facet cached from iteration to
// iteration (P5). It is not exact: a local minimum need not be the closest point, and the walk cannot cross
// where parts of the model share no node. ClosestPointTree is.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/closest_point_tree.h"

namespace trueblade {

// Immutable after construction; const functions may run from any number of threads and add to
// work.facets_tested. Keeps a reference: the model must outlive it.
class NodeWalk {
 public:
  explicit NodeWalk(const FacetModel& model);

  // The closest point on the facets of a node. By itself, from the nearest node, it fails where the closest
  // facet has no node near (Figure 3).
  ClosestPoint on_facets_of(std::uint32_t node, const Vec3& query_mm, ClosestPointWork& work) const;

  // P4: from a facet's closest point to that of the closest facet that shares a node with it, and on, until
  // no neighbour is closer or the projection falls inside the facet, which the paper takes as a local minimum
  // because it avoids looking at the neighbours.
  ClosestPoint walk(ClosestPoint start, const Vec3& query_mm, ClosestPointWork& work) const;

  // P5: the closest point of the cached facet or of its closest neighbour, where that is a local minimum in
  // the sense of `walk`; none otherwise: then the nearest node must be searched.
  std::optional<ClosestPoint> from_cached_facet(std::uint32_t facet, const Vec3& query_mm,
                                                ClosestPointWork& work) const;

 private:
  std::span<const std::uint32_t> facets_of(std::uint32_t node) const;
  void try_facet(std::uint32_t facet, const Vec3& query_mm, ClosestPoint& closest,
                 ClosestPointWork& work) const;
  bool step_to_neighbour(const Vec3& query_mm, ClosestPoint& closest, ClosestPointWork& work) const;
  bool is_local_minimum(const Vec3& query_mm, ClosestPoint& closest, ClosestPointWork& work) const;

  const FacetModel& model_;
  // Table 1: the facets of node n are facet_[first_facet_[n]] to facet_[first_facet_[n + 1] - 1].
  std::vector<std::uint32_t> first_facet_, facet_;
};

}  // namespace trueblade
