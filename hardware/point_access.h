// Whether a point of the nominal surface can be measured from a direction, and if not, why not.
#pragma once

#include <string>

#include "geometry/ray_caster.h"
#include "hardware/lens.h"
#include "hardware/probe_body.h"

namespace trueblade {

enum class PointAccess : std::uint8_t {
  measurable,
  facing_away,   // the beam would come from inside the material
  grazing,       // incidence beyond the limit
  hidden,        // another part of the surface stands before it
  beam_blocked,  // more than half of the aperture's light is cut off on its way
  probe_touches  // the housing would come too close to the part
};
inline constexpr std::size_t kPointAccessCount = 6;
std::string to_string(PointAccess access);

// Coordinates in the part frame. `caster` casts on the part. Const; any number of threads.
class AccessCheck {
 public:
  // Throws InputError when lens or body are not valid.
  AccessCheck(const RayCaster& caster, const ProbeClearance& clearance, const Lens& lens,
              const ProbeBody& body, double max_incidence_rad);

  // For a point on the surface with its outward normal, seen along the unit vector `beam` with the probe
  // origin at standoff. The cheap reasons are tested first; the first that holds is given.
  PointAccess check(const Vec3& point_mm, const Vec3& normal, const Vec3& beam) const;

 private:
  bool is_hidden(const Vec3& point_mm, const Vec3& beam) const;
  bool is_blocked(const Vec3& point_mm, const Vec3& beam) const;

  const RayCaster& caster_;
  const ProbeClearance& clearance_;
  double standoff_mm_;
  double aperture_radius_mm_;
  double least_cosine_;
};

}  // namespace trueblade
