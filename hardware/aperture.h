// The cone of light between a point and the sensor's aperture, a disc about the probe origin and across the
// beam, by eight lines to its rim: what the plan expects and what the simulation measures see the same cone.
#pragma once

#include <array>

#include "geometry/vector.h"

namespace trueblade {

// A beam ends on the surface: what stands within this distance before the point is the point's own
// surroundings (chord height of a facet's neighbours at grazing incidence).
inline constexpr double kOwnSurfaceMm = 0.05;

inline constexpr std::size_t kRimPoints = 8;

// Points of the rim, in the frame of `probe_origin_mm` and of the unit vector `beam`.
std::array<Vec3, kRimPoints> aperture_rim_mm(const Vec3& probe_origin_mm, const Vec3& beam, double radius_mm);

}  // namespace trueblade
