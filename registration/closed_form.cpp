#include "registration/closed_form.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr std::size_t kBlock = 4096;

struct Centroids {
  double weight = 0.0;
  Vec3 measured = Vec3::Zero();
  Vec3 nominal = Vec3::Zero();
  Centroids& operator+=(const Centroids& other) {
    weight += other.weight;
    measured += other.measured;
    nominal += other.nominal;
    return *this;
  }
};

struct Moments {
  Mat3 cross = Mat3::Zero();     // S of the header
  Mat3 measured = Mat3::Zero();  // second moment of the measured points
  Moments& operator+=(const Moments& other) {
    cross += other.cross;
    measured += other.measured;
    return *this;
  }
};

void check_weights(std::span<const double> weights) {
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!(weights[i] >= 0.0) || !std::isfinite(weights[i]))
      throw InputError(fmt::format("weight of point {} is {}, must be finite and at least 0", i, weights[i]));
}

Centroids weighted_centroids(std::span<const Vec3> measured, std::span<const Vec3> nominal,
                             std::span<const double> weights) {
  Centroids sum = ordered_sum(weights.size(), kBlock, Centroids{}, [&](std::size_t begin, std::size_t end) {
    Centroids part;
    for (std::size_t i = begin; i < end; ++i) {
      part.weight += weights[i];
      part.measured += weights[i] * measured[i];
      part.nominal += weights[i] * nominal[i];
    }
    return part;
  });
  if (!(sum.weight > 0.0)) throw InputError("weights are all zero, at least three must be above 0");
  sum.measured /= sum.weight;
  sum.nominal /= sum.weight;
  return sum;
}

Moments central_moments(std::span<const Vec3> measured, std::span<const Vec3> nominal,
                        std::span<const double> weights, const Centroids& mean) {
  return ordered_sum(weights.size(), kBlock, Moments{}, [&](std::size_t begin, std::size_t end) {
    Moments part;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 m = measured[i] - mean.measured;
      part.cross += weights[i] * m * (nominal[i] - mean.nominal).transpose();
      part.measured += weights[i] * m * m.transpose();
    }
    return part;
  });
}

// Points on one line (or in one point) leave a rotation undetermined. Their second eigenvalue is rounding:
// 1e-12 of the first, that is one millionth of the extent, is a hundred times the rounding of coordinates
// that are ten times as large as the extent.
void check_not_collinear(const Mat3& measured_moment) {
  const Vec3 spread =
      Eigen::SelfAdjointEigenSolver<Mat3>(measured_moment, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(spread[1] > 1e-12 * spread[2]))
    throw InputError("the points with weight lie on one line, at least three non-collinear ones are needed");
}

template <class RotationFromMoments>
RigidTransform absolute_orientation(std::span<const Vec3> measured, std::span<const Vec3> nominal,
                                    std::span<const double> weights, const RotationFromMoments& rotation_of) {
  check_weights(weights);
  const Centroids mean = weighted_centroids(measured, nominal, weights);
  const Moments moments = central_moments(measured, nominal, weights, mean);
  check_not_collinear(moments.measured);
  RigidTransform result;
  result.rotation = rotation_of(moments.cross);
  result.translation_mm = mean.nominal - result.rotation * mean.measured;
  return result;
}

Eigen::Quaterniond horn_rotation(const Mat3& s) {
  Eigen::Matrix4d n;
  n << s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),
      s(1, 2) - s(2, 1), s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2), s(2, 0) - s(0, 2),
      s(0, 1) + s(1, 0), -s(0, 0) + s(1, 1) - s(2, 2), s(1, 2) + s(2, 1), s(0, 1) - s(1, 0),
      s(2, 0) + s(0, 2), s(1, 2) + s(2, 1), -s(0, 0) - s(1, 1) + s(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(n);
  const Eigen::Vector4d q = eigen.eigenvectors().col(3);  // eigenvalues ascend
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

Eigen::Quaterniond arun_rotation(const Mat3& s) {
  const Eigen::JacobiSVD<Mat3> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 improper = svd.matrixV() * svd.matrixU().transpose();
  const Vec3 handedness(1.0, 1.0, improper.determinant() < 0.0 ? -1.0 : 1.0);
  const Mat3 rotation = svd.matrixV() * handedness.asDiagonal() * svd.matrixU().transpose();
  return Eigen::Quaterniond(rotation).normalized();
}

}  // namespace

RigidTransform absolute_orientation_by_quaternion(std::span<const Vec3> measured_mm,
                                                  std::span<const Vec3> nominal_mm,
                                                  std::span<const double> weights) {
  return absolute_orientation(measured_mm, nominal_mm, weights, horn_rotation);
}

RigidTransform absolute_orientation_by_svd(std::span<const Vec3> measured_mm,
                                           std::span<const Vec3> nominal_mm,
                                           std::span<const double> weights) {
  return absolute_orientation(measured_mm, nominal_mm, weights, arun_rotation);
}

}  // namespace trueblade
