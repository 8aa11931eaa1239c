#include "part/exact_closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

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

class NearestFoot {
 public:
  NearestFoot(const Part& part, const ClosestPoint& on_facets, const Vec3& query_mm)
      : part_(part), on_facets_(on_facets), query_mm_(query_mm) {}

  void try_surface_of(std::uint32_t facet) {
    const std::uint32_t surface = part_.model.surface_of(facet);
    const auto end = tried_.begin() + static_cast<std::ptrdiff_t>(tried_count_);
    if (tried_count_ == tried_.size() || std::find(tried_.begin(), end, surface) != end) return;
    tried_[tried_count_++] = surface;

    const auto& parameters = part_.facet_parameters[facet];
    const Vec3 weight = barycentric(part_.model.corners_mm(facet), on_facets_.point_mm).cwiseMax(0.0);
    const Vec2 start =
        (weight[0] * parameters[0] + weight[1] * parameters[1] + weight[2] * parameters[2]) / weight.sum();
    const auto foot = part_.exact->project(surface, query_mm_, start);
    const double agreement_mm = part_.chord_tolerance_mm + kTrimMarginMm;
    if (!foot.converged || std::abs(foot.distance_mm - on_facets_.distance_mm) > agreement_mm) return;
    const bool inside = foot.side == TrimSide::inside;
    // Beyond the border the foot is not on the face, and a surface that continues close to the query would
    // win for nothing.
    const auto merit = std::make_pair(
        !inside, inside ? foot.distance_mm : std::abs(foot.distance_mm - on_facets_.distance_mm));
    if (best_ && !(merit < best_merit_)) return;
    best_merit_ = merit;
    const double sign = (query_mm_ - foot.foot.point_mm).dot(foot.foot.normal) < 0.0 ? -1.0 : 1.0;
    best_ = {foot.foot, sign * foot.distance_mm, surface};
  }

  const std::optional<ExactClosestPoint>& result() const { return best_; }

 private:
  const Part& part_;
  const ClosestPoint& on_facets_;
  const Vec3& query_mm_;
  std::optional<ExactClosestPoint> best_;
  std::pair<bool, double> best_merit_;     // less is better
  std::array<std::uint32_t, 16> tried_{};  // more surfaces than this do not meet at one facet's corners
  std::size_t tried_count_ = 0;
};

}  // namespace

std::optional<ExactClosestPoint> refine_to_exact(const Part& part, const ClosestPoint& on_facets,
                                                 const Vec3& query_mm) {
  if (!part.exact || on_facets.facet == kNoFacet) return std::nullopt;
  NearestFoot nearest(part, on_facets, query_mm);
  nearest.try_surface_of(on_facets.facet);
  // The facets around the facet's corners. Inside a surface they are all on it, and nothing more is
  // projected.
  const FacetMesh& mesh = part.model.mesh();
  for (const std::uint32_t node : part.model.facet_nodes(on_facets.facet))
    for (const auto face : mesh.vf_range(FacetMesh::VertexHandle(static_cast<int>(node))))
      nearest.try_surface_of(static_cast<std::uint32_t>(face.idx()));
  return nearest.result();
}

}  // namespace trueblade
