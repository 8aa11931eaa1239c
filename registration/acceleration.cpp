#include "registration/acceleration.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace trueblade {

std::optional<double> linear_extrapolation(const Vec3& position, const Vec3& rms) {
  const Vec3 v = position.array() - position.mean();
  const Vec3 r = rms.array() - rms.mean();
  const double slope = v.dot(r) / v.squaredNorm();
  if (!(slope < 0.0)) return std::nullopt;
  return position.mean() - rms.mean() / slope;
}

std::optional<double> quadratic_extrapolation(const Vec3& position, const Vec3& rms) {
  const double left = (rms[1] - rms[0]) / (position[1] - position[0]);
  const double right = (rms[2] - rms[1]) / (position[2] - position[1]);
  const double curvature = (right - left) / (position[2] - position[0]);  // r'' / 2
  if (!(curvature > 0.0)) return std::nullopt;
  return 0.5 * (position[0] + position[1]) - left / (2.0 * curvature);
}

namespace {

// Eq. 7: the shorter of the two extrapolations, or the one there is; 0 for none.
double acceleration_length(ExtrapolationLength kind, const Vec3& position, const Vec3& rms) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double linear = linear_extrapolation(position, rms).value_or(kNone);
  const double vertex = quadratic_extrapolation(position, rms).value_or(kNone);
  const double quadratic = vertex > 0.0 ? vertex : kNone;
  const double length = kind == ExtrapolationLength::linear      ? linear
                        : kind == ExtrapolationLength::quadratic ? quadratic
                                                                 : std::min(linear, quadratic);
  return length < kNone ? length : 0.0;
}

}  // namespace

Accelerator::Accelerator(const AccelerationOptions& options, const Vec3& centroid_mcs_mm, double radius_mm)
    : options_(options), centroid_mcs_mm_(centroid_mcs_mm), radius_mm_(radius_mm) {}

std::optional<RigidTransform> Accelerator::propose(const RigidTransform& from, const RigidTransform& to,
                                                   double rms_mm) {
  switch (options_.method) {
    case AccelerationMethod::extrapolation:
      return extrapolate(to, rms_mm);
    case AccelerationMethod::anderson:
      return mix(from, to);
    case AccelerationMethod::none:
      break;
  }
  return std::nullopt;
}

void Accelerator::forget() {
  visits_.clear();
  steps_.clear();
}

Accelerator::Vec7 Accelerator::vector_of(const RigidTransform& pose, const Vec7* same_hemisphere) const {
  Vec7 vector;
  vector << pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z(),
      pose * centroid_mcs_mm_;
  // q and -q are the same rotation. A unit quaternion's step is half the angle: 2 radius makes it a length.
  if (options_.part == ExtrapolatedPart::normalised) vector.head<4>() *= 2.0 * radius_mm_;
  if (same_hemisphere && vector.head<4>().dot(same_hemisphere->head<4>()) < 0.0) vector.head<4>() *= -1.0;
  return vector;
}

RigidTransform Accelerator::pose_of(Vec7 vector) const {
  RigidTransform pose;
  pose.rotation = Eigen::Quaterniond(vector[0], vector[1], vector[2], vector[3]).normalized();
  pose.translation_mm = vector.tail<3>() - pose.rotation * centroid_mcs_mm_;
  return pose;
}

Accelerator::Vec7 Accelerator::advance(int begin, int size) const {
  Vec7 step = Vec7::Zero();
  const Eigen::VectorXd first = (visits_[1].vector - visits_[0].vector).segment(begin, size);
  const Eigen::VectorXd second = (visits_[2].vector - visits_[1].vector).segment(begin, size);
  const double length1 = first.norm(), length2 = second.norm();
  if (!(length1 > 0.0) || !(length2 > 0.0)) return step;
  const double cosine = std::clamp(first.dot(second) / (length1 * length2), -1.0, 1.0);
  if (std::acos(cosine) > options_.maximum_angle_rad) return step;

  const Vec3 position(-length2 - length1, -length2, 0.0);
  const Vec3 rms(visits_[0].rms_mm, visits_[1].rms_mm, visits_[2].rms_mm);
  const double length =
      std::min(acceleration_length(options_.length, position, rms), options_.maximum_length_ratio * length2);
  if (length > 0.0) step.segment(begin, size) = length / length2 * second;
  return step;
}

std::optional<RigidTransform> Accelerator::extrapolate(const RigidTransform& to, double rms_mm) {
  visits_.push_back({vector_of(to, visits_.empty() ? nullptr : &visits_.back().vector), rms_mm});
  if (visits_.size() > 3) visits_.erase(visits_.begin());
  if (visits_.size() < 3) return std::nullopt;
  Vec7 step = Vec7::Zero();
  switch (options_.part) {
    case ExtrapolatedPart::together:
    case ExtrapolatedPart::normalised:
      step = advance(0, 7);
      break;
    case ExtrapolatedPart::rotation_only:
      step = advance(0, 4);
      break;
    case ExtrapolatedPart::translation_only:
      step = advance(4, 3);
      break;
    case ExtrapolatedPart::separately:
      step = advance(0, 4) + advance(4, 3);
      break;
  }
  if (step.isZero(0.0)) return std::nullopt;
  return pose_of(visits_.back().vector + step);
}

std::optional<RigidTransform> Accelerator::mix(const RigidTransform& from, const RigidTransform& to) {
  if (steps_.empty()) reference_ = from;
  const Vec3 pivot = reference_ * centroid_mcs_mm_;
  const auto tangent = [&](const RigidTransform& pose) {
    Vec6 step = step_between(reference_, pose, pivot);
    step.head<3>() *= radius_mm_;
    return step;
  };
  steps_.push_back({tangent(from), tangent(to)});
  if (steps_.size() > static_cast<std::size_t>(options_.anderson_depth) + 1) steps_.erase(steps_.begin());
  const auto columns = static_cast<Eigen::Index>(steps_.size()) - 1;
  if (columns == 0) return std::nullopt;

  // The combination of the earlier steps whose combined residual (to - from) is shortest (Walker and Ni
  // 2011).
  const Step& last = steps_.back();
  Eigen::MatrixXd residual_change(6, columns), to_change(6, columns);
  for (Eigen::Index k = 0; k < columns; ++k) {
    const Step& earlier = steps_[static_cast<std::size_t>(k)];
    residual_change.col(k) = (last.to - last.from) - (earlier.to - earlier.from);
    to_change.col(k) = last.to - earlier.to;
  }
  const Eigen::VectorXd mixture =
      residual_change.completeOrthogonalDecomposition().solve(last.to - last.from);
  Vec6 mixed = last.to - to_change * mixture;
  if (!mixed.allFinite()) return std::nullopt;
  mixed.head<3>() /= radius_mm_;
  return moved_about(reference_, mixed, pivot);
}

}  // namespace trueblade
