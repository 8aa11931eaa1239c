#include "sim/vignetting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "hardware/aperture.h"

namespace trueblade {
namespace {

// Points whose ways to the rim are cast together.
constexpr std::size_t kTogether = 8;

void ways_to_rim(const VirtualPart& part, const Ray& beam, const PartHit& hit, double aperture_radius_mm,
                 std::span<LineOfSight, kRimPoints> ways) {
  const Vec3 point = beam.origin_mm + hit.range_mm * beam.direction;
  // All are as long.
  const double length_mm = std::hypot(hit.range_mm, aperture_radius_mm);
  const auto rim_mm = aperture_rim_mm(beam.origin_mm, beam.direction, aperture_radius_mm);
  for (std::size_t k = 0; k < kRimPoints; ++k) ways[k].to_mm = rim_mm[k];
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
