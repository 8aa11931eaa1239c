// Acceleration of the fixed-point iteration pose -> step(pose): the paper's extrapolation along aligned
// registration vectors (P10) and, as today's alternative, Anderson mixing.
//
// The registration vector of a pose is its unit quaternion and the position of the scan's centroid in the
// part frame. Taking the centroid as origin makes the vector independent of where the measurement coordinate
// system lies (docs/paper.md).
#pragma once

#include <optional>
#include <vector>

#include "geometry/rigid_transform.h"
#include "registration/options.h"

namespace trueblade {

// Acceleration lengths from the RMS values r1, r2, r3 at the positions v1 < v2 < v3 = 0 along the path, mm.
// Eq. 5 as corrected: where the least-squares line through the three reaches zero; none unless it falls.
std::optional<double> linear_extrapolation(const Vec3& position, const Vec3& rms);
// Eq. 6: the vertex of the parabola through the three; none unless it opens upwards.
std::optional<double> quadratic_extrapolation(const Vec3& position, const Vec3& rms);

class Accelerator {
 public:
  Accelerator(const AccelerationOptions& options, const Vec3& centroid_mcs_mm, double radius_mm);

  // Tells the accelerator the step from `from` to `to` and the RMS at `to`; returns a pose further along when
  // the history allows one. The caller drops it when it turns out worse than `to`, and then calls forget().
  std::optional<RigidTransform> propose(const RigidTransform& from, const RigidTransform& to, double rms_mm);

  void forget();

 private:
  using Vec7 = Eigen::Matrix<double, 7, 1>;
  struct Visit {
    Vec7 vector;
    double rms_mm;
  };
  struct Step {
    Vec6 from, to;  // scaled tangent at the reference pose
  };

  std::optional<RigidTransform> extrapolate(const RigidTransform& to, double rms_mm);
  std::optional<RigidTransform> mix(const RigidTransform& from, const RigidTransform& to);
  Vec7 vector_of(const RigidTransform& pose, const Vec7* same_hemisphere) const;
  RigidTransform pose_of(Vec7 vector) const;
  // Acceleration of the rows [begin, begin + size) of the last vectors; zero when they are not aligned.
  Vec7 advance(int begin, int size) const;

  AccelerationOptions options_;
  Vec3 centroid_mcs_mm_;
  double radius_mm_;
  std::vector<Visit> visits_;  // extrapolation: the last three
  std::vector<Step> steps_;    // Anderson: the last depth + 1
  RigidTransform reference_;   // Anderson: tangent point
};

}  // namespace trueblade
