// Sign of a distance: angle-weighted pseudonormals at nodes, the sum of the two facet normals at edges
// (Baerentzen and Aanaes 2005). The sign is right for every query outside or inside a closed, consistently
// oriented model.
#pragma once

#include <vector>

#include "geometry/closest_point.h"

namespace trueblade {

class PseudoNormals {
 public:
  explicit PseudoNormals(const FacetModel& model);

  // Unit outward normal of the feature on which the closest point lies.
  Vec3 normal(const ClosestPoint& closest) const;

  // +1 outside the material (or on it), -1 inside.
  double sign(const ClosestPoint& closest, const Vec3& query_mm) const;

  // Signed distance of the query to its closest point: positive outside the material.
  double signed_distance_mm(const ClosestPoint& closest, const Vec3& query_mm) const {
    return sign(closest, query_mm) * closest.distance_mm;
  }

  // True when the closest point lies on a boundary edge or boundary node of the model (an open sheet's rim;
  // P7).
  bool on_boundary(const ClosestPoint& closest) const;

 private:
  std::vector<Vec3> facet_normals_;
  std::vector<std::array<Vec3, 3>> edge_normals_;  // per facet and edge k
  std::vector<Vec3> node_normals_;
  std::vector<std::array<std::uint32_t, 3>> facet_nodes_;
  std::vector<std::uint8_t> boundary_edges_;  // bit k: edge k of the facet is a boundary edge
  std::vector<bool> boundary_node_;
};

}  // namespace trueblade
