// Rigid transforms between named frames.
//
// A variable of this type is named `target_from_source`: point_target = target_from_source * point_source, so
// that a wrong composition shows: part_from_probe = part_from_stage * stage_from_probe. Rotation is a unit
// quaternion (w, x, y, z in files), translation in millimetres.
#pragma once

#include <Eigen/Geometry>

#include "geometry/vector.h"

namespace trueblade {

struct RigidTransform {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 translation_mm = Vec3::Zero();

  Vec3 operator*(const Vec3& point_mm) const { return rotation * point_mm + translation_mm; }
  RigidTransform inverse() const;
};

// target_from_middle * middle_from_source; the rotation is renormalised.
RigidTransform operator*(const RigidTransform& target_from_middle, const RigidTransform& middle_from_source);

// Rotation by the vector omega (axis times angle in rad) and its inverse; exact to rounding at zero angle
// too.
Eigen::Quaterniond rotation_from_vector(const Vec3& rotation_rad);
Vec3 vector_from_rotation(const Eigen::Quaterniond& rotation);

// The pose moved by a small rigid step given in the target frame about `pivot_mm` (a point of the target
// frame):
//   x -> R(step.head<3>) (x - pivot) + pivot + step.tail<3>,   step = (rotation in rad, translation in mm).
// This is the tangent of every 6-vector and 6 x 6 covariance of the project; the pivot is the scan centroid.
RigidTransform moved_about(const RigidTransform& target_from_source, const Vec6& step, const Vec3& pivot_mm);

// The step that takes `from` to `to`, the inverse of moved_about.
Vec6 step_between(const RigidTransform& from, const RigidTransform& to, const Vec3& pivot_mm);

// Angle of the rotation between two poses, rad, in [0, pi].
double rotation_angle_between(const RigidTransform& a, const RigidTransform& b);

// True when every number is finite.
bool is_finite(const RigidTransform& transform);

}  // namespace trueblade
