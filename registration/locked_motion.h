// Locked degrees of freedom: the motion from the initial pose, seen in a frame fixed in the part, is
//   x -> R(rho) x + tau,
// and the locked components of the rotation vector rho and of tau stay exactly zero. Steps are solved in the
// space of the free components and applied to rho and tau themselves, so that no step adds up to a locked
// motion.
#pragma once

#include "registration/normal_equations.h"

namespace trueblade {

class LockedMotion {
 public:
  LockedMotion(const LockOptions& options, const RigidTransform& initial_part_from_mcs);

  // Orthonormal basis of the scaled steps that the locks allow at this pose.
  FreeDirections directions(const RigidTransform& part_from_mcs, const StepFrame& frame) const;

  // The pose after a step (scaled) within `directions`. Without locks this is moved_about.
  RigidTransform moved(const RigidTransform& part_from_mcs, const Vec6& step_scaled,
                       const StepFrame& frame) const;

  bool any() const { return free_.size() < 6; }

 private:
  Vec6 parameters(const RigidTransform& part_from_mcs) const;  // rho, tau
  // d(scaled step) / d(free parameters).
  FreeDirections jacobian(const Vec6& parameters, const StepFrame& frame) const;

  std::vector<int> free_;  // rows of (rho, tau) that may move
  RigidTransform initial_part_from_mcs_;
  RigidTransform part_from_frame_;
};

}  // namespace trueblade
