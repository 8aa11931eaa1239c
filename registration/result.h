// What a registration returns. It never returns a plausible identity: `termination` says why it stopped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/closest_point_tree.h"
#include "geometry/rigid_transform.h"

namespace trueblade {

enum class Termination {
  converged_statistically,  // the step is small against the pose's own uncertainty
  converged_rms,            // the RMS changed by less than the threshold
  converged_step,           // the step is shorter than the threshold
  iteration_limit,          // stopped without convergence
  no_descent,               // no step lowers the objective any further, and no threshold was met
  too_few_correspondences   // rejection left fewer than the pose needs
};
std::string to_string(Termination termination);
bool is_converged(Termination termination);

struct IterationTrace {
  RigidTransform part_from_mcs;
  double weighted_rms_mm;
  std::size_t inliers;
  double step_rotation_rad;
  double step_translation_mm;  // of the scan centroid
  double cut_mm;               // residuals beyond it were rejected; infinity where the rule has no cut
  bool accelerated;
};

// A direction of the 6-dimensional pose that the scan does not determine. It was not moved.
struct UndeterminedDirection {
  Vec6 direction;     // unit in the scaled tangent: rotation (rad, times the scan radius) then translation
  std::string words;  // "rotation about an axis through ... along ...", "translation along ..."
};

// Independent answers by Ceres to the same problems: the registration and the covariance at its end, and the
// closed form of the absolute orientation on the last correspondences.
struct CrossCheck {
  double rotation_difference_rad;
  double centroid_difference_mm;
  double covariance_relative_difference;  // largest of all elements, over the two standard deviations
  double closed_form_rotation_difference_rad;
  double closed_form_difference_mm;  // largest over the points with weight
  std::string summary;
  bool agrees;
};

struct RegistrationResult {
  RigidTransform part_from_mcs;
  // Of the tangent step (rotation rad, translation mm) about the scan centroid in the part frame; see
  // moved_about. Rows and columns of undetermined or locked directions are zero in that direction.
  Mat6 covariance = Mat6::Zero();
  Vec3 centroid_part_mm = Vec3::Zero();  // the weighted scan centroid (inliers), in the part frame: the pivot
  double sigma_mm = 0.0;                 // standard deviation of the distances used for the covariance
  bool sigma_estimated = true;           // from the residuals, or given

  Termination termination = Termination::iteration_limit;
  int iterations = 0;
  std::size_t inliers = 0;
  std::size_t outliers = 0;
  std::vector<bool> is_inlier;  // per scan point

  // At the initial pose, unweighted, no rejection, of the points that the first iterations use: an even
  // subsample of a large scan.
  double first_rms_mm = 0.0;
  double weighted_rms_mm = 0.0;  // what was minimised: sqrt(sum w d^2 / sum w) over the inliers
  double rms_mm = 0.0;           // unweighted RMS distance of the inliers
  // The residuals of neighbouring inliers agree: form errors of the part, another part, or a wrong minimum.
  bool shows_misfit = false;

  std::vector<UndeterminedDirection> undetermined;
  std::vector<IterationTrace> trace;
  ClosestPointWork work;
  std::optional<CrossCheck> cross_check;
};

// One line, and a table of everything.
std::string brief_report(const RegistrationResult& result);
std::string full_report(const RegistrationResult& result);

}  // namespace trueblade
