#include "sim/vignetting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace trueblade {

double free_light(const VirtualPart& part, const Ray& beam, const PartHit& hit, double aperture_radius_mm) {
  constexpr std::size_t kRays = 8;
  // What a ray meets this near is the surroundings of the point itself, as in the plan (point_access.cpp).
  constexpr double kOwnSurfaceMm = 0.05;
  const Vec3 point = beam.origin_mm + hit.range_mm * beam.direction;
  const Vec3 u = beam.direction.unitOrthogonal(), v = beam.direction.cross(u);
  std::array<Ray, kRays> rays;
  double length_mm = 0.0;  // of all alike
  double least_cosine = 1.0;
  for (std::size_t k = 0; k < kRays; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kRays;
    const Vec3 to_rim =
        beam.origin_mm + aperture_radius_mm * (std::cos(angle) * u + std::sin(angle) * v) - point;
    length_mm = to_rim.norm();
    rays[k] = {point, to_rim / length_mm};
    least_cosine = std::min(least_cosine, std::abs(hit.normal.dot(rays[k].direction)));
  }
  // A point on the CAD surface may lie under its facets by the chord tolerance.
  const double under_facets_mm =
      hit.refined ? part.nominal->chord_tolerance_mm / std::max(least_cosine, 0.05) : 0.0;
  std::array<std::optional<RayHit>, kRays> blocking;
  part.caster->first_hits(rays, kOwnSurfaceMm + under_facets_mm, length_mm, blocking);
  const auto free =
      std::count_if(blocking.begin(), blocking.end(), [](const auto& hit_on_way) { return !hit_on_way; });
  return static_cast<double>(free) / kRays;
}

}  // namespace trueblade
