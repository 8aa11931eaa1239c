// The plane of a triangle, computed so that thin triangles keep as much of their normal as double allows.
#pragma once

#include <Eigen/Geometry>

#include "geometry/vector.h"

namespace trueblade {

// Twice the area times the unit normal of the triangle (a, b, c), counter-clockwise seen from the normal's
// side; zero when two corners coincide. Taken from the two shortest edges: their product loses an ulp of
// itself, which in a thin triangle is far less than an ulp of the product with its longest edge.
inline Vec3 triangle_area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = ab.squaredNorm(), bc2 = bc.squaredNorm(), ca2 = ca.squaredNorm();
  if (ab2 >= bc2 && ab2 >= ca2) return bc.cross(ca);
  if (bc2 >= ca2) return ca.cross(ab);
  return ab.cross(bc);
}

}  // namespace trueblade
