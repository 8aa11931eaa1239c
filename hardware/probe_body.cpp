#include "hardware/probe_body.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace trueblade {

void ProbeBody::validate() const {
  const auto require = [](const char* name, double value, bool holds, const char* constraint) {
    if (!holds || !std::isfinite(value))
      throw InputError(fmt::format("probe body: {} is {}, must be {}", name, value, constraint));
  };
  require("radius_mm", radius_mm, radius_mm > 0.0, "above 0");
  require("length_mm", length_mm, length_mm > 0.0, "above 0");
  require("aperture_radius_mm", aperture_radius_mm,
          aperture_radius_mm >= 0.0 && aperture_radius_mm <= radius_mm, "at least 0 and at most radius_mm");
  require("clearance_mm", clearance_mm, clearance_mm >= 0.0, "at least 0");
}

ProbeClearance::ProbeClearance(const FacetModel& part, const ProbeBody& body) : tree_(part), body_(body) {
  body_.validate();
}

double ProbeClearance::spare_mm(const Vec3& probe_origin, const Vec3& beam, double enough_mm) const {
  // March along the capsule's axis: the distance to the part changes by no more than the step, so that from
  // a place with spare s the next place that could be worse than the worst so far is s - worst away.
  const double reach_mm = body_.radius_mm + body_.clearance_mm;
  double worst_mm = enough_mm;
  // The front end of the capsule is round: its axis begins one radius behind the origin.
  const double end_mm = body_.radius_mm + body_.length_mm;
  std::uint32_t warm_facet = kNoFacet;
  for (double along_mm = body_.radius_mm; along_mm <= end_mm;) {
    const ClosestPoint closest = tree_.query(probe_origin - along_mm * beam, warm_facet);
    warm_facet = closest.facet;
    const double spare = closest.distance_mm - reach_mm;
    worst_mm = std::min(worst_mm, spare);
    along_mm += std::max(kResolutionMm, spare - worst_mm);
  }
  return worst_mm;
}

bool ProbeClearance::way_is_free(const Vec3& from, const Vec3& to, const Vec3& beam) const {
  const double way_mm = (to - from).norm();
  for (double gone_mm = 0.0;;) {
    const Vec3 at = way_mm > 0.0 ? Vec3(from + (gone_mm / way_mm) * (to - from)) : from;
    const double spare = spare_mm(at, beam, way_mm - gone_mm + kResolutionMm);
    if (spare < 0.0) return false;
    if (gone_mm >= way_mm) return true;
    gone_mm = std::min(way_mm, gone_mm + std::max(kResolutionMm, spare));
  }
}

}  // namespace trueblade
