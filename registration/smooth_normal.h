// The normal of the smooth surface behind the facets, as far as the facets tell: the angle-weighted normals
// of the corners, interpolated over the facet. Facets whose normals differ by more than the crease angle
// belong to different smooth surfaces and are not averaged.
//
// A facet's own normal errs by up to half the angle between neighbouring facets, and differently on each
// facet; a facetted cylinder then seems to determine its rotation. The interpolated normal errs to second
// order only.
#pragma once

#include "geometry/closest_point.h"

namespace trueblade {

inline constexpr double kCreaseAngleRad = 0.7;  // 40 degrees: nine facets around a circle are still smooth

// Unit normal at `point_mm` of the facet (part frame).
Vec3 smooth_normal(const FacetModel& model, std::uint32_t facet, const Vec3& point_mm);

}  // namespace trueblade
