// From the closest point on the facets to the foot point on the CAD surface behind the facet.
#pragma once

#include <optional>

#include "geometry/closest_point.h"
#include "part/part.h"

namespace trueblade {

// Projects `query_mm` (part frame) onto the CAD surface of the facet on which `closest` lies, starting from
// the surface parameters interpolated over the facet. None where the part has no exact surfaces, the
// projection does not converge, or the foot lies outside the face: then the facet's answer is the better one.
std::optional<SurfacePoint> exact_foot(const Part& part, const ClosestPoint& closest, const Vec3& query_mm);

}  // namespace trueblade
