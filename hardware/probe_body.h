// The probe as a solid: its housing must not touch the part, and the cone of light between lens and point
// must be free.
#pragma once

#include "geometry/closest_point_tree.h"
#include "geometry/facet_model.h"

namespace trueblade {

// A round housing behind the probe origin: a capsule whose front end lies at the origin, along the beam
// backwards. The light passes an aperture at the origin.
struct ProbeBody {
  double radius_mm = 15.0;
  double length_mm = 150.0;
  double aperture_radius_mm = 3.0;
  double clearance_mm = 1.0;  // least distance between housing and part

  void validate() const;  // throws InputError naming the value and the constraint
};

// Distances between the housing and a part. Coordinates in the part frame (PCS). Const; any number of
// threads.
class ProbeClearance {
 public:
  ProbeClearance(const FacetModel& part, const ProbeBody& body);

  // Distance from the housing (probe origin, beam direction) to the part, less the required clearance:
  // negative when it is too close. Exact to kResolutionMm; where the part is farther than `enough_mm`, any
  // number above that.
  double spare_mm(const Vec3& probe_origin, const Vec3& beam, double enough_mm) const;

  // Whether the housing, moved straight from one probe origin to the other, keeps its clearance all the way:
  // by conservative advancement, no step being longer than the spare distance at its start.
  bool way_is_free(const Vec3& from, const Vec3& to, const Vec3& beam) const;

  static constexpr double kResolutionMm = 0.05;  // small against any clearance that one would ask for

 private:
  ClosestPointTree tree_;
  ProbeBody body_;
};

}  // namespace trueblade
