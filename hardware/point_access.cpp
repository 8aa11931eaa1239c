#include "hardware/point_access.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "hardware/aperture.h"

namespace trueblade {
std::string to_string(PointAccess access) {
  switch (access) {
    case PointAccess::measurable:
      return "measurable";
    case PointAccess::facing_away:
      return "faces away";
    case PointAccess::grazing:
      return "incidence beyond the limit";
    case PointAccess::hidden:
      return "hidden by the part";
    case PointAccess::beam_blocked:
      return "light cut off by the part";
    case PointAccess::probe_touches:
      return "probe would touch the part";
  }
  return "";
}

AccessCheck::AccessCheck(const RayCaster& caster, const ProbeClearance& clearance, const Lens& lens,
                         const ProbeBody& body, double max_incidence_rad)
    : caster_(caster),
      clearance_(clearance),
      standoff_mm_(lens.standoff_mm),
      aperture_radius_mm_(body.aperture_radius_mm),
      least_cosine_(std::cos(max_incidence_rad)) {
  lens.validate();
  body.validate();
}

PointAccess AccessCheck::check(const Vec3& point_mm, const Vec3& normal, const Vec3& beam) const {
  const double cosine = -normal.dot(beam);
  if (cosine <= 0.0) return PointAccess::facing_away;
  if (cosine < least_cosine_) return PointAccess::grazing;
  if (is_hidden(point_mm, beam)) return PointAccess::hidden;
  if (is_blocked(point_mm, beam)) return PointAccess::beam_blocked;
  if (clearance_.spare_mm(point_mm - standoff_mm_ * beam, beam, 0.0) < 0.0) return PointAccess::probe_touches;
  return PointAccess::measurable;
}

bool AccessCheck::is_hidden(const Vec3& point_mm, const Vec3& beam) const {
  // From the point outwards, so that the whole part is on the way.
  return caster_.first_hit({point_mm, -beam}, kOwnSurfaceMm, std::numeric_limits<double>::infinity())
      .has_value();
}

bool AccessCheck::is_blocked(const Vec3& point_mm, const Vec3& beam) const {
  if (aperture_radius_mm_ == 0.0) return false;
  std::size_t blocked = 0;
  for (const Vec3& rim_mm : aperture_rim_mm(point_mm - standoff_mm_ * beam, beam, aperture_radius_mm_)) {
    const Vec3 to_rim = rim_mm - point_mm;
    const double length_mm = to_rim.norm();
    blocked += caster_.first_hit({point_mm, to_rim / length_mm}, kOwnSurfaceMm, length_mm) ? 1 : 0;
  }
  return 2 * blocked > kRimPoints;
}

}  // namespace trueblade
