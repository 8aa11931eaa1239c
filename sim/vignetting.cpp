#include "sim/vignetting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace trueblade {
namespace {

constexpr std::size_t kRimPoints = 8;
// Points whose ways to the rim are cast together.
constexpr std::size_t kTogether = 8;

// Unit vectors to the rim, across the beam.
std::array<Vec2, kRimPoints> rim() {
  std::array<Vec2, kRimPoints> points;
  for (std::size_t k = 0; k < kRimPoints; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kRimPoints;
    points[k] = {std::cos(angle), std::sin(angle)};
  }
  return points;
}

void ways_to_rim(const VirtualPart& part, const Ray& beam, const PartHit& hit, double aperture_radius_mm,
                 std::span<LineOfSight, kRimPoints> ways) {
  static const std::array<Vec2, kRimPoints> kRim = rim();
  // What stands this near is the surroundings of the point itself, as in the plan (point_access.cpp).
  constexpr double kOwnSurfaceMm = 0.05;
  const Vec3 point = beam.origin_mm + hit.range_mm * beam.direction;
  const Vec3 u = aperture_radius_mm * beam.direction.unitOrthogonal(), v = beam.direction.cross(u);
  // All are as long.
  const double length_mm = std::hypot(hit.range_mm, aperture_radius_mm);
  for (std::size_t k = 0; k < kRimPoints; ++k)
    ways[k].to_mm = beam.origin_mm + kRim[k].x() * u + kRim[k].y() * v;
  double start_mm = kOwnSurfaceMm;
  if (hit.refined) {
    // A point on the CAD surface may lie under its facets by the chord tolerance.
    double least_cosine = 1.0;
    for (const LineOfSight& way : ways)
      least_cosine = std::min(least_cosine, std::abs(hit.normal.dot(way.to_mm - point)) / length_mm);
    start_mm += part.nominal->chord_tolerance_mm / std::max(least_cosine, 0.05);
  }
  for (LineOfSight& way : ways) way.from_mm = point + start_mm / length_mm * (way.to_mm - point);
}

}  // namespace

void free_light(const VirtualPart& part, std::span<const Ray> beams,
                std::span<const std::optional<PartHit>> hits, double aperture_radius_mm,
                std::span<double> light) {
  std::array<LineOfSight, kTogether * kRimPoints> ways;
  std::array<bool, kTogether * kRimPoints> blocked;
  std::array<std::size_t, kTogether> points;
  std::size_t count = 0;
  const auto cast = [&] {
    part.caster->blocked_lines(std::span(ways).first(count * kRimPoints),
                               std::span(blocked).first(count * kRimPoints));
    for (std::size_t i = 0; i < count; ++i) {
      const auto free = std::ranges::count(std::span(blocked).subspan(i * kRimPoints, kRimPoints), false);
      light[points[i]] = static_cast<double>(free) / kRimPoints;
    }
    count = 0;
  };
  for (std::size_t k = 0; k < beams.size(); ++k) {
    light[k] = 1.0;
    if (!hits[k]) continue;
    ways_to_rim(part, beams[k], *hits[k], aperture_radius_mm,
                std::span(ways).subspan(count * kRimPoints).first<kRimPoints>());
    points[count++] = k;
    if (count == kTogether) cast();
  }
  cast();
}

}  // namespace trueblade
