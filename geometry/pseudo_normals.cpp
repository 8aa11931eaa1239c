#include "geometry/pseudo_normals.h"

#include <algorithm>
#include <cmath>

#include "geometry/facet_edges.h"
#include "geometry/triangle.h"

namespace trueblade {
namespace {

// Angle at `apex` between the directions to `b` and `c`, in [0, pi]; atan2 keeps its accuracy near both ends.
double angle_at(const Vec3& apex, const Vec3& b, const Vec3& c) {
  return std::atan2((b - apex).cross(c - apex).norm(), (b - apex).dot(c - apex));
}

// Zero stays zero: the two sides of a fold onto itself cancel, and then no direction is outward.
Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace

// Everything is summed per place (welded node, edge between welded nodes), over all facets that meet there
// and not only over one fan of the mesh: the theorem needs the whole boundary of the material around the
// point, manifold or not.
PseudoNormals::PseudoNormals(const FacetModel& model)
    : facet_normals_(model.facet_count()),
      edge_normals_(model.facet_count()),
      node_normals_(model.node_count(), Vec3::Zero()),
      facet_nodes_(model.facet_count()),
      boundary_edges_(model.facet_count(), 0),
      boundary_node_(model.node_count(), false) {
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
    const std::array<Vec3, 3> corners = model.corners_mm(facet);
    facet_normals_[facet] = model.facet_normal(facet);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = model.welded_node(model.facet_nodes(facet)[k]);
      facet_nodes_[facet][k] = node;
      node_normals_[node] +=
          angle_at(corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]) * facet_normals_[facet];
    }
  }
  for (Vec3& normal : node_normals_) normal = unit_or_zero(normal);

  const FacetEdges edges(facet_nodes_, model.node_count());
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    const auto uses = edges.uses(edge);
    Vec3 sum = Vec3::Zero();
    for (const EdgeUse& use : uses) sum += facet_normals_[use.facet];
    for (const EdgeUse& use : uses) edge_normals_[use.facet][use.edge] = unit_or_zero(sum);
    if (uses.size() > 1) continue;
    boundary_edges_[uses[0].facet] |= static_cast<std::uint8_t>(1u << uses[0].edge);
    boundary_node_[facet_nodes_[uses[0].facet][uses[0].edge]] = true;
    boundary_node_[facet_nodes_[uses[0].facet][(uses[0].edge + 1) % 3]] = true;
  }
}

Vec3 PseudoNormals::normal(const ClosestPoint& closest) const {
  switch (closest.feature) {
    case FacetFeature::interior:
      return facet_normals_[closest.facet];
    case FacetFeature::edge_0:
      return edge_normals_[closest.facet][0];
    case FacetFeature::edge_1:
      return edge_normals_[closest.facet][1];
    case FacetFeature::edge_2:
      return edge_normals_[closest.facet][2];
    case FacetFeature::node_0:
      return node_normals_[facet_nodes_[closest.facet][0]];
    case FacetFeature::node_1:
      return node_normals_[facet_nodes_[closest.facet][1]];
    case FacetFeature::node_2:
      return node_normals_[facet_nodes_[closest.facet][2]];
  }
  return facet_normals_[closest.facet];
}

double PseudoNormals::sign(const ClosestPoint& closest, const Vec3& query_mm) const {
  return normal(closest).dot(query_mm - closest.point_mm) < 0.0 ? -1.0 : 1.0;
}

bool PseudoNormals::on_boundary(const ClosestPoint& closest) const {
  switch (closest.feature) {
    case FacetFeature::interior:
      return false;
    case FacetFeature::edge_0:
      return (boundary_edges_[closest.facet] & 1u) != 0;
    case FacetFeature::edge_1:
      return (boundary_edges_[closest.facet] & 2u) != 0;
    case FacetFeature::edge_2:
      return (boundary_edges_[closest.facet] & 4u) != 0;
    case FacetFeature::node_0:
      return boundary_node_[facet_nodes_[closest.facet][0]];
    case FacetFeature::node_1:
      return boundary_node_[facet_nodes_[closest.facet][1]];
    case FacetFeature::node_2:
      return boundary_node_[facet_nodes_[closest.facet][2]];
  }
  return false;
}

}  // namespace trueblade
