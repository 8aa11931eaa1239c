// From the closest point on the facets to the closest point on the CAD surfaces, so that the facet error is
// gone from the last steps of a registration and from the deviations.
#pragma once

#include <optional>

#include "geometry/closest_point.h"
#include "part/part.h"

namespace trueblade {

struct ExactClosestPoint {
  SurfacePoint foot;
  double distance_mm;     // signed: positive outside the material
  std::uint32_t surface;  // may be a neighbour of the facet's surface
};

// Projects the query onto the surfaces of its closest facet and of that facet's neighbours, started from the
// facets' parameters. A foot point counts when its distance agrees with that to the facets, which is wrong by
// at most the chord tolerance: what differs more is the foot on another part of a surface or on its
// continuation beyond an edge. The nearest foot point inside its face wins; if there is none, the nearest
// point on an edge with a neighbour; else (a border without an edge) the foot point within the trimming
// margin that agrees best with the facets. At an edge the normal is the way to the query, so that distance
// and normal stay those of one smooth function there. A neighbour whose facets are farther away than a foot
// point inside its face by more than they may be wrong is not tried.
//
// nullopt when no projection converges to a foot point on a face or an edge: the closest point is a corner,
// or the part has no exact surfaces. The caller then keeps the facet's answer.
std::optional<ExactClosestPoint> refine_to_exact(const Part& part, const ClosestPoint& on_facets,
                                                 const Vec3& query_mm);

}  // namespace trueblade
