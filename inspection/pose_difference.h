// How one fit of the part stands against another: the platform against the airfoil, one view against another.
#pragma once

#include <array>
#include <string>

#include "registration/result.h"

namespace trueblade {

// The rigid displacement, in the part frame, of what `of` was fitted to, seen by one who trusts `from`:
//   D = part_from_mcs(from) * part_from_mcs(of)^-1,
// written as a step (rotation rad, translation mm) about `pivot_mm`, the centroid of the points of `of`. A
// platform that was shifted by s against the airfoil gives translation s.
struct PoseDifference {
  std::string of, from;
  Vec3 pivot_mm = Vec3::Zero();
  Vec6 step = Vec6::Zero();
  // The sum of both covariances at the pivot: right for fits to different points.
  Mat6 covariance = Mat6::Zero();
  // False where one of the fits does not determine the component; its numbers mean nothing then.
  std::array<bool, 6> determined{true, true, true, true, true, true};
};

PoseDifference pose_difference(const std::string& of, const RegistrationResult& fit_of,
                               const std::string& from, const RegistrationResult& fit_from);

}  // namespace trueblade
