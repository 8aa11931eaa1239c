// Short names for the fixed-size vectors and matrices of the project (Eigen, double).
#pragma once

#include <Eigen/Core>

namespace trueblade {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

}  // namespace trueblade
