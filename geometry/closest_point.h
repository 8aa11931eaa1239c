// Closest point on a facet and on a facet model: the query concept that all search structures share.
#pragma once

#include <cstdint>
#include <limits>

#include "geometry/facet_model.h"
#include "geometry/vector.h"

namespace trueblade {

// Where on its facet a closest point lies: it decides the sign (pseudonormal) and the boundary policy (P7).
// edge_k joins corner k and corner k+1 (mod 3).
enum class FacetFeature : std::uint8_t { interior, edge_0, edge_1, edge_2, node_0, node_1, node_2 };

inline constexpr std::uint32_t kNoFacet = std::numeric_limits<std::uint32_t>::max();

struct ClosestPoint {
  Vec3 point_mm = Vec3::Zero();
  double distance_mm = std::numeric_limits<double>::infinity();  // unsigned
  std::uint32_t facet = kNoFacet;
  FacetFeature feature = FacetFeature::interior;
};

struct FacetPoint {
  Vec3 point_mm;
  FacetFeature feature;
};

// Closest point of the triangle (a, b, c) to `query`, by the Voronoi regions of its features (Ericson
// 2005, 5.1.5). Degenerate triangles are handled as segments or points. A foot point that lies exactly on an
// edge or a node belongs to the edge or the node.
FacetPoint closest_point_on_facet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& query);

// The slow twin: every facet is tried. Exact; the reference that every search structure is tested against.
ClosestPoint closest_point_brute_force(const FacetModel& model, const Vec3& query_mm);

}  // namespace trueblade
