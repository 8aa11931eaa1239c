#include "geometry/closest_point.h"

#include <algorithm>
#include <cmath>

#include "geometry/triangle.h"

namespace trueblade {
namespace {

// Closest point of edge k, the segment (from, to), to the query.
FacetPoint closest_point_on_edge(int k, const Vec3& from, const Vec3& to, const Vec3& query) {
  constexpr FacetFeature kEdges[] = {FacetFeature::edge_0, FacetFeature::edge_1, FacetFeature::edge_2};
  constexpr FacetFeature kNodes[] = {FacetFeature::node_0, FacetFeature::node_1, FacetFeature::node_2};
  const Vec3 along = to - from;
  const double reach = along.dot(query - from);
  const double length_squared = along.squaredNorm();
  if (reach <= 0.0 || length_squared == 0.0) return {from, kNodes[k]};
  if (reach >= length_squared) return {to, kNodes[(k + 1) % 3]};
  return {from + along * (reach / length_squared), kEdges[k]};
}

}  // namespace

FacetPoint closest_point_on_facet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& query) {
  const Vec3 corners[] = {a, b, c};
  const Vec3 edges[] = {b - a, c - b, a - c};
  const Vec3 area = triangle_area_vector(a, b, c);
  const double area_squared = area.squaredNorm();

  // A triangle of height h over its longest edge L has a normal that is uncertain by about eps L / h. Below h
  // = 1.5e-8 L (sqrt eps) that moves the foot point by more than calling the triangle its three edges does.
  const double longest_squared =
      std::max({edges[0].squaredNorm(), edges[1].squaredNorm(), edges[2].squaredNorm()});
  const bool has_plane = area_squared > 2.2e-16 * longest_squared * longest_squared;

  bool outside[3];
  for (int k = 0; k < 3; ++k)
    outside[k] = !has_plane || !(area.cross(edges[k]).dot(query - corners[k]) > 0.0);

  if (!outside[0] && !outside[1] && !outside[2]) {
    const double height = area.dot(query - a) / area_squared;
    return {query - height * area, FacetFeature::interior};
  }

  // Otherwise the closest point lies on an edge beyond which the query lies.
  FacetPoint closest{a, FacetFeature::node_0};
  double closest_squared = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (!outside[k]) continue;
    const FacetPoint candidate = closest_point_on_edge(k, corners[k], corners[(k + 1) % 3], query);
    const double distance_squared = (query - candidate.point_mm).squaredNorm();
    if (distance_squared < closest_squared) {
      closest = candidate;
      closest_squared = distance_squared;
    }
  }
  return closest;
}

ClosestPoint closest_point_brute_force(const FacetModel& model, const Vec3& query_mm) {
  ClosestPoint closest;
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
    const auto [a, b, c] = model.corners_mm(facet);
    const FacetPoint candidate = closest_point_on_facet(a, b, c, query_mm);
    const double distance = (query_mm - candidate.point_mm).norm();
    if (distance < closest.distance_mm) closest = {candidate.point_mm, distance, facet, candidate.feature};
  }
  return closest;
}

}  // namespace trueblade
