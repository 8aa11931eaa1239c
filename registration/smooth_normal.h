// The normal of the smooth surface behind the facets, as far as the facets tell: the normals of the corners,
// interpolated over the facet. A corner's normal is the mean of its facets' normals with Max's weights
// |e1 x e2| / (|e1|^2 |e2|^2), e1 and e2 the facet's edges there, which is exact on spheres (Max 1999,
// "Weights for computing vertex normals from facet normals"). Facets whose normals differ by more than the
// crease angle belong to different smooth surfaces and are not averaged.
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
