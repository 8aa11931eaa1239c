#include "hardware/aperture.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace trueblade {
namespace {

std::array<Vec2, kRimPoints> unit_rim() {
  std::array<Vec2, kRimPoints> points;
  for (std::size_t k = 0; k < kRimPoints; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kRimPoints;
    points[k] = {std::cos(angle), std::sin(angle)};
  }
  return points;
}

}  // namespace

std::array<Vec3, kRimPoints> aperture_rim_mm(const Vec3& probe_origin_mm, const Vec3& beam,
                                             double radius_mm) {
  static const std::array<Vec2, kRimPoints> kUnitRim = unit_rim();
  const Vec3 u = radius_mm * beam.unitOrthogonal(), v = beam.cross(u);
  std::array<Vec3, kRimPoints> rim;
  for (std::size_t k = 0; k < kRimPoints; ++k)
    rim[k] = probe_origin_mm + kUnitRim[k].x() * u + kUnitRim[k].y() * v;
  return rim;
}

}  // namespace trueblade
