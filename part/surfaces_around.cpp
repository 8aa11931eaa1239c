#include "part/surfaces_around.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace trueblade {
namespace {

// The facets at the corners that are on other surfaces, those of one surface together.
std::vector<std::uint32_t> facets_around(const FacetModel& model, std::uint32_t facet) {
  std::vector<std::uint32_t> around;
  for (const std::uint32_t node : model.facet_nodes(facet))
    for (const auto face : model.mesh().vf_range(FacetMesh::VertexHandle(static_cast<int>(node)))) {
      const auto other = static_cast<std::uint32_t>(face.idx());
      if (model.surface_of(other) != model.surface_of(facet)) around.push_back(other);
    }
  std::sort(around.begin(), around.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(model.surface_of(a), a) < std::pair(model.surface_of(b), b);
  });
  return around;
}

// How far the facets reach along `normal`.
double reach_mm(const FacetModel& model, std::span<const std::uint32_t> facets, const Vec3& normal) {
  double farthest = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t facet : facets)
    for (const Vec3& corner : model.corners_mm(facet)) farthest = std::max(farthest, normal.dot(corner));
  return farthest;
}

SurfaceAround surface_around(const FacetModel& model, std::uint32_t facet,
                             std::span<const std::uint32_t> of_surface) {
  const auto corners = model.corners_mm(facet);
  const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  SurfaceAround best{of_surface.front(), Vec3::Zero(), std::numeric_limits<double>::infinity()};
  const auto try_normal = [&](const Vec3& direction) {
    const Vec3 normal = direction.normalized();
    const SurfaceAround tried{of_surface.front(), normal, reach_mm(model, of_surface, normal)};
    if (tried.least_distance_mm(middle) > best.least_distance_mm(middle)) best = tried;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    try_normal(model.facet_normal(facet).cross(edge));
    try_normal(middle - corners[k]);
  }
  return best;
}

}  // namespace

SurfacesAround::SurfacesAround(const FacetModel& model) {
  begin_.reserve(model.facet_count() + 1);
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
    begin_.push_back(surfaces_.size());
    const std::vector<std::uint32_t> around = facets_around(model, facet);
    for (auto first = around.begin(); first != around.end();) {
      const auto end = std::find_if(first, around.end(), [&](std::uint32_t other) {
        return model.surface_of(other) != model.surface_of(*first);
      });
      surfaces_.push_back(surface_around(model, facet, {first, end}));
      first = end;
    }
  }
  begin_.push_back(surfaces_.size());
}

}  // namespace trueblade
