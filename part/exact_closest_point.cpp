#include "part/exact_closest_point.h"

#include <cmath>
#include <utility>

#include "part/facet_parameters.h"
#include "part/surfaces_around.h"

namespace trueblade {

namespace {

class NearestFoot {
 public:
  NearestFoot(const Part& part, const ClosestPoint& on_facets, const Vec3& query_mm)
      : part_(part), on_facets_(on_facets), query_mm_(query_mm) {}

  void try_surface_of(std::uint32_t facet) {
    const std::uint32_t surface = part_.model.surface_of(facet);
    const Vec2 start = parameters_beside(part_, facet, on_facets_.point_mm);
    const auto foot = part_.exact->project(surface, query_mm_, start);
    if (!foot.converged || std::abs(foot.distance_mm - on_facets_.distance_mm) > agreement_mm_) return;
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

  // Whether no foot point behind facets so far away can be nearer than the one found.
  bool is_nearest_below(double distance_mm) const {
    return best_ && !best_merit_.first && best_merit_.second + agreement_mm_ < distance_mm;
  }

  const std::optional<ExactClosestPoint>& result() const { return best_; }

 private:
  const Part& part_;
  const ClosestPoint& on_facets_;
  const Vec3& query_mm_;
  double agreement_mm_ = part_.chord_tolerance_mm + kTrimMarginMm;  // of distances to facets and surface
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
  return nearest.result();
}

}  // namespace trueblade
