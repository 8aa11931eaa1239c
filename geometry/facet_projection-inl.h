// Projection of points onto facets in double, as many at a time as the instruction set holds. Included once
// per instruction set, inside Highway's target regions.
//
// No fused multiply-add: the same operations in the same order give the same bits on every machine.
#if defined(TRUEBLADE_FACET_PROJECTION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRUEBLADE_FACET_PROJECTION_INL_H
#undef TRUEBLADE_FACET_PROJECTION_INL_H
#else
#define TRUEBLADE_FACET_PROJECTION_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Vector {
  V x, y, z;
};
template <class V>
HWY_INLINE Vector<V> operator-(const Vector<V>& a, const Vector<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Vector<V> operator+(const Vector<V>& a, const Vector<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Vector<V> operator*(const V& s, const Vector<V>& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
template <class V>
HWY_INLINE V dot(const Vector<V>& a, const Vector<V>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class V>
HWY_INLINE Vector<V> cross(const Vector<V>& a, const Vector<V>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class M, class V>
HWY_INLINE Vector<V> select(const M& condition, const Vector<V>& yes, const Vector<V>& no) {
  return {hn::IfThenElse(condition, yes.x, no.x), hn::IfThenElse(condition, yes.y, no.y),
          hn::IfThenElse(condition, yes.z, no.z)};
}

template <class V>
struct FacetFoot {
  Vector<V> point;
  V distance_squared;
  V feature;  // the number of the FacetFeature
};

// Offers the closest point of the edge (from, to) to `best`; numbers of the features beside.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void offer_edge(D d, const Vector<V>& from, const Vector<V>& to, const Vector<V>& along,
                           const V& length_squared, const Vector<V>& query, double edge, double from_node,
                           double to_node, FacetFoot<V>& best) {
  const auto zero = hn::Zero(d);
  const Vector<V> from_query = query - from;
  const V reach = dot(along, from_query);
  const auto at_from = hn::Or(hn::Le(reach, zero), hn::Eq(length_squared, zero));
  const auto at_to = hn::Ge(reach, length_squared);
  const V t = hn::IfThenElse(at_from, zero, hn::Div(reach, length_squared));
  const Vector<V> step = t * along;
  const Vector<V> away = select(at_from, from_query, select(at_to, query - to, from_query - step));
  const V distance_squared = dot(away, away);
  const auto closer = hn::Lt(distance_squared, best.distance_squared);
  const Vector<V> point = select(at_from, from, select(at_to, to, from + step));
  const V feature = hn::IfThenElse(at_from, hn::Set(d, from_node),
                                   hn::IfThenElse(at_to, hn::Set(d, to_node), hn::Set(d, edge)));
  best.point = select(closer, point, best.point);
  best.distance_squared = hn::IfThenElse(closer, distance_squared, best.distance_squared);
  best.feature = hn::IfThenElse(closer, feature, best.feature);
}

// Closest point of the triangle (a, b, c) to `query`. Precondition: (c, a) is the longest edge, so that the
// normal comes from the two shorter ones and a thin triangle keeps as much of it as double allows.
template <class D, class V = hn::Vec<D>>
HWY_INLINE FacetFoot<V> project_onto_facet(D d, const Vector<V>& a, const Vector<V>& b, const Vector<V>& c,
                                           const Vector<V>& query) {
  const auto zero = hn::Zero(d);
  const Vector<V> ab = b - a, bc = c - b, ca = a - c;
  const Vector<V> area = cross(ab, bc);
  const V area_squared = dot(area, area), ca2 = dot(ca, ca);
  const Vector<V> aq = query - a, bq = query - b;

  // The query over the three edges; the three sum to area_squared.
  const V beside_ab = dot(cross(area, ab), aq), beside_bc = dot(cross(area, bc), bq);
  const V beside_ca = hn::Sub(hn::Sub(area_squared, beside_ab), beside_bc);
  // Thinner than sqrt(eps) of its length, a triangle is its edges: its normal is uncertain by more.
  const auto has_plane = hn::Gt(area_squared, hn::Mul(hn::Set(d, 2.2e-16), hn::Mul(ca2, ca2)));
  const auto inside = hn::And(has_plane, hn::Gt(hn::Min(hn::Min(beside_ab, beside_bc), beside_ca), zero));

  const V reach = dot(area, aq);
  const V height = hn::Div(reach, area_squared);
  const Vector<V> plane_point = query - height * area;
  const V plane_distance_squared = hn::Mul(reach, height);
  if (hn::AllTrue(d, inside)) return {plane_point, plane_distance_squared, zero};

  FacetFoot<V> best{a, hn::Set(d, std::numeric_limits<double>::infinity()), zero};
  offer_edge(d, a, b, ab, dot(ab, ab), query, 1.0, 4.0, 5.0, best);
  offer_edge(d, b, c, bc, dot(bc, bc), query, 2.0, 5.0, 6.0, best);
  offer_edge(d, c, a, ca, ca2, query, 3.0, 6.0, 4.0, best);
  return {select(inside, plane_point, best.point),
          hn::IfThenElse(inside, plane_distance_squared, best.distance_squared),
          hn::IfThenElse(inside, zero, best.feature)};
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#endif
