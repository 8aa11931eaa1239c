// Independent answers by Ceres to the problems that the registration solves in its own way. The one place
// that includes Ceres.
#pragma once

#include <optional>
#include <span>

#include "registration/correspondences.h"
#include "registration/normal_equations.h"
#include "registration/result.h"

namespace trueblade {

// Minimises sum_i w_i || nominal_i - T measured_i ||^2 by Levenberg-Marquardt on a unit quaternion and a
// translation about the centroids, from `start`: what closed_form.h answers without iterating. Preconditions
// as there.
RigidTransform absolute_orientation_by_ceres(std::span<const Vec3> measured_mm,
                                             std::span<const Vec3> nominal_mm,
                                             std::span<const double> weights, const RigidTransform& start);

// What a converged registration claims.
struct RegistrationClaim {
  const RegistrationTarget& target;
  bool exact;  // distances from the CAD surfaces where there are any, else from the facets
  std::span<const Vec3> position_mcs_mm;
  std::span<const Vec3> closest_part_mm;  // at that pose, one per position
  std::span<const double> weights;        // after rejection, 0 for outliers
  RigidTransform part_from_mcs;
  StepFrame frame;            // at that pose
  FreeDirections determined;  // scaled tangent, the directions that could move
  Mat6 covariance_scaled;     // of the pose
  Mat6 hessian;               // sum w J J', scaled
  // Where the covariance claims to be sigma^2 (sum J J')^-1: without weights, and with a cut that hardly
  // touches the good points.
  std::optional<double> sigma_mm;
};

// Lets Ceres minimise sum_i w_i d(T x_i)^2 with d the true distance, searched anew at every evaluation, over
// the determined directions from the claimed pose, and compares the pose, the inverse of the normal matrix
// and, with sigma_mm, the covariance with Ceres's. They agree when the poses differ by less than a tenth of
// the pose's standard uncertainty (or 1e-9 mm, for noise-free scans) and variances and covariances by less
// than 2 % (of the two standard deviations): the closest features, and with them the normals, may differ
// between two poses a tenth of an uncertainty apart. The same point pairs also go through the closed form and
// through Ceres, which must agree to 1e-10 rad and 1e-9 mm. Throws InputError when the points with weight lie
// on one line.
CrossCheck cross_check_registration(const RegistrationClaim& claim);

}  // namespace trueblade
