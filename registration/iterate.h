// The iteration of the registration on one set of points: correspondences, rejection, step, acceleration and
// step control, until a reason to stop.
#pragma once

#include <optional>

#include "registration/acceleration.h"
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
  double floor_mm;  // rounding of a distance
};

// One set of points on its way: the pose, and everything known at the pose.
struct Iterations {
  RigidTransform part_from_mcs;
  Correspondences correspondences;
  std::vector<double> base;     // weights before rejection, 0 where not eligible
  std::vector<double> weights;  // after it
  StepFit fit;
  FreeDirections determined, undetermined;
  int iterations = 0;
  std::vector<IterationTrace> trace;
  ClosestPointWork work;
  double first_rms_mm = 0.0;  // unweighted, all eligible points, at the first pose
};

// Moves `state.part_from_mcs` until a termination criterion of the options is met, or, when `rough`, until a
// step moves no point by more than options.sampling.until_step_sigma. `state.iterations` counts on from its
// value. With `exact`, the CAD surfaces themselves take the place of the facets.
std::optional<Termination> iterate(const RegistrationProblem& problem, const WorkingScan& scan, bool rough,
                                   Iterations& state);

}  // namespace trueblade
