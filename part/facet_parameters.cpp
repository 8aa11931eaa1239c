#include "part/facet_parameters.h"

#include <algorithm>

namespace trueblade {

Vec2 parameters_beside(const Part& part, std::uint32_t facet, const Vec3& point_mm) {
  const auto corners = part.model.corners_mm(facet);
  const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], r = point_mm - corners[0];
  // Barycentric weights of the foot on the facet's plane.
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2);
  const double determinant = a * c - b * b;
  const double w1 = std::clamp((c * r.dot(e1) - b * r.dot(e2)) / determinant, 0.0, 1.0);
  const double w2 = std::clamp((a * r.dot(e2) - b * r.dot(e1)) / determinant, 0.0, 1.0);
  const auto& uv = part.facet_parameters[facet];
  return uv[0] + w1 * (uv[1] - uv[0]) + w2 * (uv[2] - uv[0]);
}

}  // namespace trueblade
