// Float distances inside a leaf, with a bound of their error. Included once per instruction set.
#if defined(TRUEBLADE_LEAF_DISTANCES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRUEBLADE_LEAF_DISTANCES_INL_H
#undef TRUEBLADE_LEAF_DISTANCES_INL_H
#else
#define TRUEBLADE_LEAF_DISTANCES_INL_H
#endif

#include <cmath>
#include <limits>

#include "geometry/facet_tree.h"

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kTreeWidth>;

// Bounds the error of a float distance inside a leaf, and of the comparisons made with it, as a fraction of
// |query - centre| + radius: about 30 roundings of 2^-24 are 1.8e-6.
constexpr float kFloatError = 4e-6F;
// Six roundings of 2^-24 in a sum of three squares are 3.6e-7.
constexpr float kSquareError = 1e-6F;
// One rounding to float, 2^-24, and one more for the product.
constexpr float kUlp = 1.2e-7F;

// A facet in its frame (see FacetTreeLeaf).
template <class V>
struct FrameFacet {
  V a, b, height, inverse_ca2, inverse_cb2;
};

// Squared distance of the point (x, y, z) of the frame to the facet.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V distance_squared_in_frame(D d, const FrameFacet<V>& facet, V x, V y, V z) {
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  // Edge AB, the line y = -h from x = a to x = b.
  const auto above = hn::Add(y, facet.height);
  const auto beside = hn::Sub(x, hn::Min(hn::Max(x, facet.a), facet.b));
  auto nearest = hn::MulAdd(beside, beside, hn::Mul(above, above));
  // Edges CA and CB: t (a, -h) and t (b, -h) with t in [0, 1].
  const auto yh = hn::Mul(y, facet.height);
  const auto to_edge = [&](const V& end, const V& inverse_length2) HWY_ATTR {
    const auto reached = hn::Mul(hn::MulSub(x, end, yh), inverse_length2);
    const auto t = hn::Min(hn::Max(reached, zero), one);
    const auto dx = hn::NegMulAdd(t, end, x), dy = hn::MulAdd(t, facet.height, y);
    return hn::MulAdd(dx, dx, hn::Mul(dy, dy));
  };
  nearest =
      hn::Min(nearest, hn::Min(to_edge(facet.a, facet.inverse_ca2), to_edge(facet.b, facet.inverse_cb2)));
  // Above AB, and on the inner side of CA (x h + y a >= 0) and of CB (x h + y b <= 0), only z counts.
  const auto xh = hn::Mul(x, facet.height);
  const auto inside = hn::Min(above, hn::Min(hn::MulAdd(y, facet.a, xh), hn::NegMulSub(y, facet.b, xh)));
  nearest = hn::IfThenElse(hn::Ge(inside, zero), zero, nearest);
  return hn::MulAdd(z, z, nearest);
}

// Float distances of one query to the facets of one leaf.
struct LeafDistances {
  alignas(32) float squared[kTreeWidth];
  float least_squared;
  float error;  // of each distance
};

HWY_ATTR HWY_INLINE void test_leaf(const FacetTreeLeaf& leaf, const Vec3& query_mm,
                                   LeafDistances& distances) {
  const Floats d;
  float local[3];
  float reach = leaf.radius_mm;
  for (int axis = 0; axis < 3; ++axis) {
    local[axis] = static_cast<float>(query_mm[axis] - leaf.centre_mm[axis]);
    reach += std::abs(local[axis]);
  }
  distances.error = kFloatError * reach;
  const auto qx = hn::Set(d, local[0]), qy = hn::Set(d, local[1]), qz = hn::Set(d, local[2]);
  auto least = hn::Set(d, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < kTreeWidth; i += hn::Lanes(d)) {
    const auto along = [&](const float(&direction)[3][kTreeWidth], const float* offset) HWY_ATTR {
      auto sum = hn::MulSub(hn::Load(d, direction[0] + i), qx, hn::Load(d, offset + i));
      sum = hn::MulAdd(hn::Load(d, direction[1] + i), qy, sum);
      return hn::MulAdd(hn::Load(d, direction[2] + i), qz, sum);
    };
    const FrameFacet<hn::Vec<Floats>> facet{hn::Load(d, leaf.a + i), hn::Load(d, leaf.b + i),
                                            hn::Load(d, leaf.height + i), hn::Load(d, leaf.inverse_ca2 + i),
                                            hn::Load(d, leaf.inverse_cb2 + i)};
    const auto squared =
        distance_squared_in_frame(d, facet, along(leaf.u, leaf.origin[0]), along(leaf.v, leaf.origin[1]),
                                  along(leaf.w, leaf.origin[2]));
    hn::Store(squared, d, distances.squared + i);
    least = hn::Min(least, squared);
  }
  distances.least_squared = hn::GetLane(hn::MinOfLanes(d, least));
}

// The facets within the distance, as bits.
HWY_ATTR HWY_INLINE std::uint32_t lanes_within(const FacetTreeLeaf& leaf, const LeafDistances& distances,
                                               float distance_squared) {
  const Floats d;
  const auto limit = hn::Set(d, distance_squared);
  std::uint32_t within = 0;
  for (std::size_t i = 0; i < kTreeWidth; i += hn::Lanes(d)) {
    std::uint8_t bits = 0;
    hn::StoreMaskBits(d, hn::Le(hn::Load(d, distances.squared + i), limit), &bits);
    within |= static_cast<std::uint32_t>(bits) << i;
  }
  return within & ((1U << leaf.facets) - 1U);
}

// The least squared distance of the other facets.
HWY_ATTR HWY_INLINE float second_least_squared(LeafDistances& distances, std::uint32_t best) {
  const Floats d;
  const float kept = distances.squared[best];
  distances.squared[best] = std::numeric_limits<float>::infinity();
  auto least = hn::Load(d, distances.squared);
  for (std::size_t i = hn::Lanes(d); i < kTreeWidth; i += hn::Lanes(d))
    least = hn::Min(least, hn::Load(d, distances.squared + i));
  distances.squared[best] = kept;
  return hn::GetLane(hn::MinOfLanes(d, least));
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#endif
