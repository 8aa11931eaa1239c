// The preliminary transformation of the set-up (P12) from a few points on the part whose coordinates are
// known, each measured by the machine with the beam brought to it by hand.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/rigid_transform.h"

namespace trueblade {

struct TouchedPoint {
  std::string name;
  Vec3 part_mm;  // in the part's frame (PCS), from the drawing or the CAD model
  Vec3 mcs_mm;   // as measured
};

struct PartLocation {
  RigidTransform mcs_from_part;
  // Of a step (rotation, translation; MCS, geometry/rigid_transform.h) about `pivot_mcs_mm`, the mean of the
  // measured points: every coordinate of every point is taken to be off by sigma, independently.
  Mat6 covariance;
  Vec3 pivot_mcs_mm;
  std::vector<Vec3> residual_mcs_mm;  // measured minus located, one per point
  double rms_mm;                      // of their lengths
};

// The rigid transformation of least squares, in closed form (registration/closed_form.h). `sigma_mm`: how
// well the beam is brought onto a point.
// Throws InputError: fewer than three points; a name that is missing or given twice; coordinates that are not
// finite; points so near one line that the rotation is not determined to 0.1 rad; points that contradict each
// other by more than sigma explains (chi square of their residuals above its 99.9 % quantile), naming the one
// with the greatest residual.
PartLocation locate_part(std::span<const TouchedPoint> points, double sigma_mm);

}  // namespace trueblade
