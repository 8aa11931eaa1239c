// The iteration of the registration on one set of points: correspondences, rejection, step, acceleration and
// step control, until there is a reason to stop.
#pragma once

#include <optional>

#include "registration/correspondences.h"
#include "registration/fit_step.h"
#include "registration/locked_motion.h"
#include "registration/result.h"
#include "registration/working_scan.h"

namespace trueblade {

// What stays the same during one registration.
struct RegistrationProblem {
  const RegistrationTarget& target;
  const RegistrationOptions& options;
  LockedMotion motion;
  ScanExtent extent;
  double floor_mm;          // rounding of a distance
  Eigen::Index frozen = 0;  // so many least determined directions are not moved
};

// A registration on its way: the pose, and everything known at the pose.
struct RegistrationState {
  RigidTransform part_from_mcs;
  Correspondences correspondences;
  std::vector<double> base;     // weights before rejection, 0 where not eligible
  std::vector<double> weights;  // after it
  StepFit fit;
  FreeDirections determined, undetermined;
  bool asked_what_is_determined = false;  // determinacy.h, at some pose before; then:
  bool all_determined = false;
  bool settled = false;  // the last step moved no point by more than options.sampling.until_step_sigma
  int iterations = 0;    // steps tried
  std::vector<IterationTrace> trace;
  ClosestPointWork work;
  double first_rms_mm = 0.0;  // unweighted, all eligible points, at the first pose
};

enum class IterationGoal {
  near_the_minimum,  // until a step moves no point by more than options.sampling.until_step_sigma
  termination        // until a criterion of options.termination is met
};

// Moves `state` from its pose on the points of `scan` until `goal`; the goal itself is no termination. With
// `exact`, the CAD surfaces take the place of their facets.
//
// With options.step.control no pose of the trace has a higher objective than the one before it: the rule's
// own, sum w rho(distance) over all points, with closest points found anew and the scale and the weights of
// the one before (consistent_cut: rho(d) = min(|d|, cut)^2; least_median_of_squares: the sum of squares over
// its selection). A step that would raise it is halved. The last step, from the last pose of the trace to the
// result, met a criterion to stop and is not looked at.
std::optional<Termination> iterate(const RegistrationProblem& problem, const WorkingScan& scan,
                                   IterationGoal goal, bool exact, RegistrationState& state);

}  // namespace trueblade
