#include "part/exact_closest_point.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "part/exact_edge_point.h"
#include "part/facet_parameters.h"
#include "part/surfaces_around.h"

namespace trueblade {

namespace {

// Nearer to an edge than this the direction from it, wrong by up to the edge point's own error over the
// distance, is less certain than 0.001 rad. What the distance there loses with the surfaces' mean normal
// instead is itself below a nanometre.
constexpr double kOnEdge_mm = 1e3 * kFootPrecision_mm;

// A foot point is known to kFootPrecision_mm along its surface, and a direction 1e-4 rad off the normal
// changes a distance by 5e-9 of it. What is farther off is no foot point: the surface ends there, at a bound
// of its parameters.
bool is_perpendicular(const SurfacePoint& foot, const Vec3& query_mm) {
  const Vec3 way_mm = query_mm - foot.point_mm;
  return way_mm.cross(foot.normal).norm() <= 1e-4 * way_mm.norm() + kFootPrecision_mm;
}

class NearestFoot {
 public:
  NearestFoot(const Part& part, const ClosestPoint& on_facets, const Vec3& query_mm)
      : part_(part), on_facets_(on_facets), query_mm_(query_mm) {}

  void try_surface_of(std::uint32_t facet) {
    const std::uint32_t surface = part_.model.surface_of(facet);
    const Vec2 start = parameters_beside(part_, facet, on_facets_.point_mm);
    const auto foot = part_.exact->project(surface, query_mm_, start);
    if (!foot.converged || std::abs(foot.distance_mm - on_facets_.distance_mm) > agreement_mm_) return;
    const bool inside = is_on_face(foot.side);
    // Beyond the border the foot is not on the face, and a surface that continues close to the query would
    // win for nothing.
    const auto merit = std::make_pair(
        !inside, inside ? foot.distance_mm : std::abs(foot.distance_mm - on_facets_.distance_mm));
    const double sign = (query_mm_ - foot.foot.point_mm).dot(foot.foot.normal) < 0.0 ? -1.0 : 1.0;
    const ExactClosestPoint found{foot.foot, sign * foot.distance_mm, surface};
    const bool is_at_bound = !is_perpendicular(foot.foot, query_mm_);
    if (foot.side == TrimSide::inside && !is_at_bound &&
        (!inside_ || foot.distance_mm < std::abs(inside_->distance_mm)))
      inside_ = found;
    if (best_ && !(merit < best_merit_)) return;
    best_merit_ = merit;
    best_facet_ = facet;
    is_at_border_ = foot.side == TrimSide::border || is_at_bound;
    is_at_bound_ = is_at_bound;
    best_ = found;
  }

  // Whether the foot point found may be beyond an edge, or there is none on a face.
  bool needs_edges() const { return !is_on_a_face() || is_at_border_; }

  // Where the query is beyond the borders of all the surfaces, or the foot point found is beyond this edge of
  // its face, the closest point is on the edge.
  void try_edge(std::uint32_t facet_b) {
    const std::uint32_t facet_a = is_on_a_face() ? best_facet_ : on_facets_.facet;
    if (part_.model.surface_of(facet_a) == part_.model.surface_of(facet_b)) return;
    const auto edge = closest_point_on_edge(part_, facet_a, facet_b, query_mm_, on_facets_.point_mm);
    if (!edge) return;
    if (edge->beyond_end) {
      is_beyond_an_edge_ = true;
      return;
    }
    const bool is_cut_off =
        !is_on_a_face() || is_at_bound_ || edge->out_of_a.dot(best_->foot.point_mm - edge->point_mm) > 0.0;
    const bool agrees = std::abs(edge->distance_mm - on_facets_.distance_mm) <= agreement_mm_;
    if (is_cut_off && agrees && (!edge_ || edge->distance_mm < edge_->distance_mm)) edge_ = edge;
  }

  void take_edge() {
    if (!edge_) return;
    if (inside_ && std::abs(inside_->distance_mm) <= edge_->distance_mm) {
      best_ = inside_;
      return;
    }
    const std::uint32_t facet = is_on_a_face() ? best_facet_ : on_facets_.facet;
    const Vec3 from_edge_mm = query_mm_ - edge_->point_mm;
    const double sign = from_edge_mm.dot(edge_->normal) < 0.0 ? -1.0 : 1.0;
    best_ = {{edge_->point_mm, edge_->normal, parameters_beside(part_, facet, edge_->point_mm)},
             sign * edge_->distance_mm,
             part_.model.surface_of(facet)};
    best_merit_ = {false, edge_->distance_mm};
    is_at_bound_ = true;
  }

  // Where a face ends, the way to the query is the direction in which the distance grows; on the edge itself
  // there is none.
  void turn_normal_to_query() {
    if (!best_ || !is_at_bound_ || std::abs(best_->distance_mm) <= kOnEdge_mm) return;
    best_->foot.normal = (query_mm_ - best_->foot.point_mm) / best_->distance_mm;
  }

  // Past the end of an edge, and the nearest of the facets is a node: the corner, which the facets have, too.
  bool is_at_a_corner() const {
    return !is_on_a_face() && is_beyond_an_edge_ && on_facets_.feature >= FacetFeature::node_0;
  }
  bool is_on_a_face() const { return best_ && !best_merit_.first; }

  // Whether no foot point behind facets so far away can be nearer than the one found.
  bool is_nearest_below(double distance_mm) const {
    return is_on_a_face() && best_merit_.second + agreement_mm_ < distance_mm;
  }

  const std::optional<ExactClosestPoint>& result() const { return best_; }

 private:
  const Part& part_;
  const ClosestPoint& on_facets_;
  const Vec3& query_mm_;
  double agreement_mm_ = part_.chord_tolerance_mm + kTrimMarginMm;  // of distances to facets and surface
  std::uint32_t best_facet_ = kNoFacet;
  // The best foot point: within the precision of the trimming curves or at the end of its face; at the end of
  // its face, where its normal is not the way to the query.
  bool is_at_border_ = false, is_at_bound_ = false;
  bool is_beyond_an_edge_ = false;
  std::optional<ExactClosestPoint> inside_;  // the nearest that is inside its face beyond doubt
  std::optional<ExactEdgePoint> edge_;
  std::optional<ExactClosestPoint> best_;
  std::pair<bool, double> best_merit_;  // less is better
};

}  // namespace

std::optional<ExactClosestPoint> refine_to_exact(const Part& part, const ClosestPoint& on_facets,
                                                 const Vec3& query_mm) {
  if (!part.exact || on_facets.facet == kNoFacet) return std::nullopt;
  NearestFoot nearest(part, on_facets, query_mm);
  nearest.try_surface_of(on_facets.facet);
  for (const SurfaceAround& around : part.surfaces_around->of(on_facets.facet))
    if (!nearest.is_nearest_below(around.least_distance_mm(query_mm))) nearest.try_surface_of(around.facet);
  if (!nearest.needs_edges()) return nearest.result();
  nearest.try_edge(on_facets.facet);
  for (const SurfaceAround& around : part.surfaces_around->of(on_facets.facet))
    nearest.try_edge(around.facet);
  nearest.take_edge();
  nearest.turn_normal_to_query();
  if (nearest.is_at_a_corner()) return std::nullopt;
  return nearest.result();
}

}  // namespace trueblade
