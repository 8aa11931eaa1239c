// A surface's point and partial derivatives up to the second order at (u, v).
#pragma once

#include "geometry/vector.h"

namespace trueblade {

struct SurfaceDerivatives {
  Vec3 point, du, dv, duu, duv, dvv;
};

}  // namespace trueblade
