#include "registration/locked_motion.h"

#include <Eigen/QR>
#include <algorithm>

#include "registration/rotation_jacobian.h"

namespace trueblade {
LockedMotion::LockedMotion(const LockOptions& options, const RigidTransform& initial_part_from_mcs)
    : initial_part_from_mcs_(initial_part_from_mcs), part_from_frame_(options.part_from_frame) {
  part_from_frame_.rotation.normalize();
  for (int k = 0; k < 6; ++k)
    if (std::find(options.freedoms.begin(), options.freedoms.end(), static_cast<Freedom>(k)) ==
        options.freedoms.end())
      free_.push_back(k);
}

Vec6 LockedMotion::parameters(const RigidTransform& part_from_mcs) const {
  const RigidTransform motion =
      part_from_frame_.inverse() * part_from_mcs * initial_part_from_mcs_.inverse() * part_from_frame_;
  Vec6 p;
  p << vector_from_rotation(motion.rotation), motion.translation_mm;
  return p;
}

FreeDirections LockedMotion::jacobian(const Vec6& parameters, const StepFrame& frame) const {
  // A point x of the frame moves by dx = omega x (x - tau) + d tau with omega = J(rho) d rho; the step is its
  // rotation and the motion of the pivot, in the part frame.
  const Mat3 rotation_of_rho = rotation_jacobian(parameters.head<3>());
  const Vec3 arm = part_from_frame_.inverse() * frame.pivot_part_mm - parameters.tail<3>();
  FreeDirections result(6, static_cast<Eigen::Index>(free_.size()));
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const bool turns = free_[k] < 3;
    const Vec3 omega = turns ? Vec3(rotation_of_rho.col(free_[k])) : Vec3(Vec3::Zero());
    const Vec3 velocity = turns ? Vec3(omega.cross(arm)) : Vec3(Vec3::Unit(free_[k] - 3));
    Vec6 step;
    step << part_from_frame_.rotation * omega, part_from_frame_.rotation * velocity;
    result.col(static_cast<Eigen::Index>(k)) = frame.scaled(step);
  }
  return result;
}

FreeDirections LockedMotion::directions(const RigidTransform& part_from_mcs, const StepFrame& frame) const {
  if (!any()) return FreeDirections::Identity(6, 6);
  const FreeDirections columns = jacobian(parameters(part_from_mcs), frame);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns);
  return Eigen::MatrixXd(qr.householderQ()).leftCols(columns.cols());
}

RigidTransform LockedMotion::moved(const RigidTransform& part_from_mcs, const Vec6& step_scaled,
                                   const StepFrame& frame) const {
  if (!any()) return moved_about(part_from_mcs, frame.unscaled(step_scaled), frame.pivot_part_mm);
  Vec6 p = parameters(part_from_mcs);
  const Eigen::MatrixXd columns = jacobian(p, frame);
  const Eigen::VectorXd change = columns.householderQr().solve(step_scaled);
  for (int k = 0; k < 6; ++k)  // locked components hold rounding, not motion
    if (std::find(free_.begin(), free_.end(), k) == free_.end()) p[k] = 0.0;
  for (std::size_t k = 0; k < free_.size(); ++k) p[free_[k]] += change[static_cast<Eigen::Index>(k)];
  RigidTransform motion;
  motion.rotation = rotation_from_vector(p.head<3>());
  motion.translation_mm = p.tail<3>();
  return part_from_frame_ * motion * part_from_frame_.inverse() * initial_part_from_mcs_;
}

}  // namespace trueblade
