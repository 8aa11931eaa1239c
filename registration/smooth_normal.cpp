#include "registration/smooth_normal.h"

#include <Eigen/Geometry>

#include <cmath>

namespace trueblade {
namespace {

Vec3 corner_normal(const FacetModel& model, std::uint32_t node, const Vec3& facet_normal) {
  const double least_cosine = std::cos(kCreaseAngleRad);
  const Vec3 here = model.node_mm(node);
  Vec3 sum = Vec3::Zero();
  for (const auto face : model.mesh().vf_range(OpenMesh::VertexHandle(static_cast<int>(node)))) {
    const auto& nodes = model.facet_nodes(static_cast<std::uint32_t>(face.idx()));
    const std::size_t k = nodes[0] == node ? 0 : nodes[1] == node ? 1 : 2;
    const Vec3 a = model.node_mm(nodes[(k + 1) % 3]) - here, b = model.node_mm(nodes[(k + 2) % 3]) - here;
    const Vec3 area = a.cross(b);
    if (area.dot(facet_normal) >= least_cosine * area.norm())
      sum += area / (a.squaredNorm() * b.squaredNorm());
  }
  return sum.normalized();
}

}  // namespace

Vec3 smooth_normal(const FacetModel& model, std::uint32_t facet, const Vec3& point_mm) {
  const auto corner = model.corners_mm(facet);
  const Vec3 area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  const Vec3 normal = area.normalized();
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& next = corner[(k + 1) % 3];
    const Vec3& last = corner[(k + 2) % 3];
    const double weight = (next - point_mm).cross(last - point_mm).dot(normal);  // barycentric, up to scale
    sum += std::max(0.0, weight) * corner_normal(model, model.facet_nodes(facet)[k], normal);
  }
  return sum.normalized();
}

}  // namespace trueblade
