#include "part/exact_ray_hit.h"

#include <cmath>
#include <utility>

#include "part/facet_parameters.h"
#include "part/surfaces_around.h"

namespace trueblade {
namespace {

class FirstHit {
 public:
  FirstHit(const Part& part, const Ray& ray, std::uint32_t facet, double facet_range_mm)
      : part_(part),
        ray_(ray),
        facet_range_mm_(facet_range_mm),
        facing_(part.model.facet_normal(facet).dot(ray.direction)) {}

  void try_surface_of(std::uint32_t facet) {
    const std::uint32_t surface = part_.model.surface_of(facet);
    auto meeting = meet(surface, facet, facet_range_mm_);
    // Grazing, the beam leaves the part within the same facets: found from there, where it entered lies on
    // the other side of the facet.
    if (meeting.converged && !faces_as_facet(meeting))
      meeting = meet(surface, facet, 2.0 * facet_range_mm_ - meeting.range_mm);
    const double along_mm = std::abs(meeting.range_mm - facet_range_mm_);
    const double agreement_mm = part_.chord_tolerance_mm + kTrimMarginMm;
    if (!meeting.converged || !faces_as_facet(meeting) || along_mm * std::abs(facing_) > agreement_mm) return;
    const bool inside = is_on_face(meeting.side);
    const auto merit = std::make_pair(!inside, inside ? meeting.range_mm : along_mm);
    if (best_ && !(merit < best_merit_)) return;
    best_merit_ = merit;
    best_ = {meeting.hit, meeting.range_mm, surface};
  }

  bool is_inside() const { return best_ && !best_merit_.first; }
  const std::optional<ExactRayHit>& result() const { return best_; }

 private:
  ExactSurfaces::RayIntersection meet(std::uint32_t surface, std::uint32_t facet,
                                      double from_range_mm) const {
    const Vec2 start = parameters_beside(part_, facet, ray_.origin_mm + from_range_mm * ray_.direction);
    return part_.exact->intersect(surface, ray_.origin_mm, ray_.direction, start, from_range_mm);
  }
  bool faces_as_facet(const ExactSurfaces::RayIntersection& meeting) const {
    return meeting.hit.normal.dot(ray_.direction) * facing_ > 0.0;
  }

  const Part& part_;
  const Ray& ray_;
  double facet_range_mm_;
  double facing_;  // cosine between ray and normal of the facet that it meets
  std::optional<ExactRayHit> best_;
  std::pair<bool, double> best_merit_;  // less is better
};

}  // namespace

std::optional<ExactRayHit> refine_to_exact(const Part& part, const Ray& ray, std::uint32_t facet,
                                           double facet_range_mm) {
  if (!part.exact) return std::nullopt;
  FirstHit first(part, ray, facet, facet_range_mm);
  first.try_surface_of(facet);
  // Its own surface met within its face: no neighbour stands before it.
  if (first.is_inside()) return first.result();
  for (const SurfaceAround& around : part.surfaces_around->of(facet)) first.try_surface_of(around.facet);
  return first.result();
}

}  // namespace trueblade
