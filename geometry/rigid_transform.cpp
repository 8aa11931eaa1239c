#include "geometry/rigid_transform.h"

#include <cmath>

namespace trueblade {

RigidTransform RigidTransform::inverse() const {
  const Eigen::Quaterniond back = rotation.conjugate();
  return {back, -(back * translation_mm)};
}

RigidTransform operator*(const RigidTransform& target_from_middle, const RigidTransform& middle_from_source) {
  return {(target_from_middle.rotation * middle_from_source.rotation).normalized(),
          target_from_middle * middle_from_source.translation_mm};
}

Eigen::Quaterniond rotation_from_vector(const Vec3& rotation_rad) {
  const double angle = rotation_rad.stableNorm();
  // sin(angle / 2) / angle = 1/2 - angle^2 / 48 + ...; below 1e-8 the second term is 2e-18, under half an
  // ulp.
  const double vector_scale = angle < 1e-8 ? 0.5 : std::sin(0.5 * angle) / angle;
  const Vec3 vector = vector_scale * rotation_rad;
  return {std::cos(0.5 * angle), vector.x(), vector.y(), vector.z()};
}

Vec3 vector_from_rotation(const Eigen::Quaterniond& rotation) {
  // q and -q are the same rotation; the half with w >= 0 has the angle in [0, pi].
  const double hemisphere = std::signbit(rotation.w()) ? -1.0 : 1.0;
  const Vec3 vector = hemisphere * rotation.vec();
  const double sine = vector.stableNorm();
  if (sine == 0.0) return Vec3::Zero();
  return vector * (2.0 * std::atan2(sine, hemisphere * rotation.w()) / sine);
}

RigidTransform moved_about(const RigidTransform& target_from_source, const Vec6& step, const Vec3& pivot_mm) {
  const Eigen::Quaterniond turn = rotation_from_vector(step.head<3>());
  return {(turn * target_from_source.rotation).normalized(),
          turn * (target_from_source.translation_mm - pivot_mm) + pivot_mm + step.tail<3>()};
}

Vec6 step_between(const RigidTransform& from, const RigidTransform& to, const Vec3& pivot_mm) {
  const Eigen::Quaterniond turn = (to.rotation * from.rotation.conjugate()).normalized();
  Vec6 step;
  step.head<3>() = vector_from_rotation(turn);
  step.tail<3>() = to.translation_mm - pivot_mm - turn * (from.translation_mm - pivot_mm);
  return step;
}

double rotation_angle_between(const RigidTransform& a, const RigidTransform& b) {
  return vector_from_rotation(a.rotation * b.rotation.conjugate()).norm();
}

bool is_finite(const RigidTransform& transform) {
  return transform.rotation.coeffs().allFinite() && transform.translation_mm.allFinite();
}

}  // namespace trueblade
