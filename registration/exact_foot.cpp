#include "registration/exact_foot.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace trueblade {
namespace {

Vec2 parameters_at(const Part& part, const ClosestPoint& closest) {
  const auto corner = part.model.corners_mm(closest.facet);
  const auto& parameters = part.facet_parameters[closest.facet];
  const Vec3 area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  const double whole = area.squaredNorm();
  const Vec3 from_1 = closest.point_mm - corner[1], from_2 = closest.point_mm - corner[2];
  const double w0 = std::clamp(from_1.cross(from_2).dot(area) / whole, 0.0, 1.0);
  const double w1 = std::clamp(from_2.cross(Vec3(closest.point_mm - corner[0])).dot(area) / whole, 0.0, 1.0);
  return w0 * parameters[0] + w1 * parameters[1] + (1.0 - w0 - w1) * parameters[2];
}

}  // namespace

std::optional<SurfacePoint> exact_foot(const Part& part, const ClosestPoint& closest, const Vec3& query_mm) {
  if (!part.exact) return std::nullopt;
  const auto projection =
      part.exact->project(part.model.surface_of(closest.facet), query_mm, parameters_at(part, closest));
  if (!projection.converged) return std::nullopt;
  return projection.foot;
}

}  // namespace trueblade
