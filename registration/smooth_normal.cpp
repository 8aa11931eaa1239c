#include "registration/smooth_normal.h"

#include <Eigen/Geometry>

#include <cmath>

namespace trueblade {
namespace {

// Twice the area vector of a facet, and its angle at `node`.
struct FacetAtNode {
  Vec3 normal;
  double angle_rad;
};

FacetAtNode facet_at_node(const FacetModel& model, std::uint32_t facet, std::uint32_t node) {
  const auto& nodes = model.facet_nodes(facet);
  const auto corner = model.corners_mm(facet);
  const std::size_t k = nodes[0] == node ? 0 : nodes[1] == node ? 1 : 2;
  const Vec3 a = corner[(k + 1) % 3] - corner[k], b = corner[(k + 2) % 3] - corner[k];
  const Vec3 area = a.cross(b);
  return {area.normalized(), std::atan2(area.norm(), a.dot(b))};
}

Vec3 corner_normal(const FacetModel& model, std::uint32_t node, const Vec3& facet_normal) {
  const double least_cosine = std::cos(kCreaseAngleRad);
  Vec3 sum = Vec3::Zero();
  const OpenMesh::VertexHandle handle(static_cast<int>(node));
  for (auto f = model.mesh().cvf_begin(handle); f != model.mesh().cvf_end(handle); ++f) {
    const FacetAtNode neighbour = facet_at_node(model, static_cast<std::uint32_t>(f->idx()), node);
    if (neighbour.normal.dot(facet_normal) >= least_cosine) sum += neighbour.angle_rad * neighbour.normal;
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
