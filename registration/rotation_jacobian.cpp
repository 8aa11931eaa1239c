#include "registration/rotation_jacobian.h"

#include <cmath>

namespace trueblade {

Mat3 rotation_jacobian(const Vec3& rotation_rad) {
  const double angle = rotation_rad.norm();
  Mat3 cross;
  cross << 0.0, -rotation_rad.z(), rotation_rad.y(), rotation_rad.z(), 0.0, -rotation_rad.x(),
      -rotation_rad.y(), rotation_rad.x(), 0.0;
  // Below 1e-4 the next terms of the series, angle^2 / 24 and angle^2 / 120, are 4e-10 and less of 1.
  const bool small = angle < 1e-4;
  const double a = small ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const double b = small ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
  return Mat3::Identity() + a * cross + b * cross * cross;
}

}  // namespace trueblade
