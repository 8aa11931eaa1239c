// Left Jacobian of the rotation group: R(rho + d) = R(J d) R(rho) to first order in d.
#pragma once

#include "geometry/vector.h"

namespace trueblade {

Mat3 rotation_jacobian(const Vec3& rotation_rad);

}  // namespace trueblade
