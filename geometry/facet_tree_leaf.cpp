#include "geometry/facet_tree_leaf.h"

#include <cmath>

// Highway compiles this file once for every instruction set and picks the machine's best at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/facet_tree_leaf.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kTreeWidth>;
using Double = hn::Vec<Doubles>;
using Floats = hn::Rebind<float, Doubles>;

struct Vector {
  Double x, y, z;
};

HWY_ATTR HWY_INLINE Vector load(const double (&rows)[3][kTreeWidth], std::size_t lane) {
  const Doubles d;
  return {hn::Load(d, rows[0] + lane), hn::Load(d, rows[1] + lane), hn::Load(d, rows[2] + lane)};
}
HWY_ATTR HWY_INLINE Vector minus(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_ATTR HWY_INLINE Vector times(const Vector& a, Double factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}
HWY_ATTR HWY_INLINE Double dot(const Vector& a, const Vector& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_ATTR HWY_INLINE Vector cross(const Vector& a, const Vector& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class Mask>
HWY_ATTR HWY_INLINE Vector choose(Mask mask, const Vector& yes, const Vector& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

// a / length; where the length is 0, `otherwise`.
HWY_ATTR HWY_INLINE Vector direction(const Vector& a, Double length, const Vector& otherwise) {
  const Doubles d;
  const auto exists = hn::Gt(length, hn::Zero(d));
  return choose(exists, times(a, hn::Div(hn::Set(d, 1.0), hn::IfThenElse(exists, length, hn::Set(d, 1.0)))),
                otherwise);
}

// A unit vector across the unit vector u: u's cross product with the axis that is farthest from it.
HWY_ATTR HWY_INLINE Vector across(const Vector& u) {
  const Doubles d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const auto x = hn::Abs(u.x), y = hn::Abs(u.y), z = hn::Abs(u.z);
  const auto x_is_least = hn::And(hn::Le(x, y), hn::Le(x, z));
  const auto y_is_least = hn::AndNot(x_is_least, hn::Le(y, z));
  const Vector axis{hn::IfThenElse(x_is_least, one, zero), hn::IfThenElse(y_is_least, one, zero),
                    hn::IfThenElse(hn::Or(x_is_least, y_is_least), zero, one)};
  const Vector product = cross(u, axis);
  return times(product, hn::Div(one, hn::Sqrt(dot(product, product))));
}

HWY_ATTR HWY_INLINE void store(Double value, float* row, std::size_t lane) {
  hn::Store(hn::DemoteTo(Floats(), value), Floats(), row + lane);
}
HWY_ATTR HWY_INLINE void store(const Vector& value, float (&rows)[3][kTreeWidth], std::size_t lane) {
  store(value.x, rows[0], lane);
  store(value.y, rows[1], lane);
  store(value.z, rows[2], lane);
}

// 1 / |edge|^2. An edge below 1e-15 mm counts as its corner C: the inverse of its square would leave the
// range of float.
HWY_ATTR HWY_INLINE Double inverse_square(const Vector& edge) {
  const Doubles d;
  const auto square = dot(edge, edge);
  const auto exists = hn::Gt(square, hn::Set(d, 1e-30));
  return hn::IfThenElseZero(exists,
                            hn::Div(hn::Set(d, 1.0), hn::IfThenElse(exists, square, hn::Set(d, 1.0))));
}

HWY_ATTR void WriteLeaf(const LeafCorners& corners, FacetTreeLeaf& leaf) {
  const Doubles d;
  const auto zero = hn::Zero(d);
  const Vector centre{hn::Set(d, leaf.centre_mm[0]), hn::Set(d, leaf.centre_mm[1]),
                      hn::Set(d, leaf.centre_mm[2])};
  auto radius_squared = zero;
  for (std::size_t lane = 0; lane < kTreeWidth; lane += hn::Lanes(d)) {
    const Vector a = load(corners.a, lane), b = load(corners.b, lane), c = load(corners.c, lane);
    const Vector ab = minus(b, a), ca = minus(a, c), cb = minus(b, c);
    const Vector u = direction(ab, hn::Sqrt(dot(ab, ab)), {hn::Set(d, 1.0), zero, zero});
    Vector v = minus(times(u, dot(u, ca)), ca);
    v = minus(v, times(u, dot(u, v)));  // once more: the first difference cancels in a thin triangle
    const auto height = hn::Sqrt(dot(v, v));
    v = direction(v, height, across(u));
    const Vector w = cross(u, v), origin = minus(c, centre);
    store(u, leaf.u, lane);
    store(v, leaf.v, lane);
    store(w, leaf.w, lane);
    store({dot(u, origin), dot(v, origin), dot(w, origin)}, leaf.origin, lane);
    store(dot(u, ca), leaf.a, lane);
    store(dot(u, cb), leaf.b, lane);
    store(height, leaf.height, lane);
    store(inverse_square(ca), leaf.inverse_ca2, lane);
    store(inverse_square(cb), leaf.inverse_cb2, lane);
    for (const Vector& corner : {a, b, c}) {
      const Vector from_centre = minus(corner, centre);
      radius_squared = hn::Max(radius_squared, dot(from_centre, from_centre));
    }
  }
  const double centre_distance_mm = std::hypot(leaf.centre_mm[0], leaf.centre_mm[1], leaf.centre_mm[2]);
  // 1e-8 |centre|: coordinates of 1e4 mm are rounded to 1e-12 mm, which kFloatError times this covers 100
  // times.
  leaf.radius_mm = static_cast<float>(
      std::sqrt(hn::GetLane(hn::MaxOfLanes(d, radius_squared))) * (1.0 + 1e-6) + 1e-8 * centre_distance_mm);
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trueblade {

HWY_EXPORT(WriteLeaf);

void write_leaf(const LeafCorners& corners, FacetTreeLeaf& leaf) {
  HWY_DYNAMIC_DISPATCH(WriteLeaf)(corners, leaf);
}

}  // namespace trueblade
#endif
