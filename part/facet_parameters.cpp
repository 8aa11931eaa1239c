#include "part/facet_parameters.h"

#include <Eigen/Geometry>

namespace trueblade {
namespace {

// Weights of the corners at a point in the facet's plane.
Vec3 barycentric(const std::array<Vec3, 3>& corners_mm, const Vec3& point_mm) {
  const Vec3 ab = corners_mm[1] - corners_mm[0], ac = corners_mm[2] - corners_mm[0];
  const Vec3 normal = ab.cross(ac);
  const Vec3 ap = point_mm - corners_mm[0];
  const double b = ap.cross(ac).dot(normal) / normal.squaredNorm();
  const double c = ab.cross(ap).dot(normal) / normal.squaredNorm();
  return {1.0 - b - c, b, c};
}

}  // namespace

Vec2 parameters_beside(const Part& part, std::uint32_t facet, const Vec3& point_mm) {
  const auto& parameters = part.facet_parameters[facet];
  const Vec3 weight = barycentric(part.model.corners_mm(facet), point_mm).cwiseMax(0.0);
  return (weight[0] * parameters[0] + weight[1] * parameters[1] + weight[2] * parameters[2]) / weight.sum();
}

}  // namespace trueblade
