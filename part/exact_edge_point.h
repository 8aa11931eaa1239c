// The closest point on the edge where two CAD surfaces meet. Part frame, mm.
#pragma once

#include <optional>

#include "geometry/closest_point.h"
#include "part/part.h"

namespace trueblade {

// As near as an edge point, and a foot point along its surface, is known.
inline constexpr double kFootPrecision_mm = 1e-9;

struct ExactEdgePoint {
  Vec3 point_mm = Vec3::Zero();
  Vec3 normal = Vec3::Zero();    // unit, the mean of the two surfaces' outward normals
  double distance_mm = 0.0;      // of the query, unsigned
  Vec3 out_of_a = Vec3::Zero();  // unit, along surface a across the edge, away from its face
  // The search left the faces along the edge: a corner is nearer, and the rest is not set.
  bool beyond_end = true;
};

// The point on the surfaces of both facets that is nearest to the query, from a point near both of them: each
// step goes to the nearest point on the line where the two tangent planes meet, and converges by a factor of
// distance over radius of curvature.
//
// nullopt where the surfaces run into one another without an edge.
std::optional<ExactEdgePoint> closest_point_on_edge(const Part& part, std::uint32_t facet_a,
                                                    std::uint32_t facet_b, const Vec3& query_mm,
                                                    const Vec3& start_mm);

}  // namespace trueblade
