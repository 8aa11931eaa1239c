#include "geometry/facet_tree_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/facet_tree_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes8 = hn::CappedTag<float, kTreeWidth>;

// A float distance inside a leaf is wrong by at most this times (|query - centre| + radius): about 25
// roundings of 2^-24 in the frame, the frame's own rounding and the square root; 64 of them is 3.8e-6.
constexpr float kFloatError = 4e-6F;
// A box's lower bound is a sum of three squares of rounded differences: relative error below 6 * 2^-24
// = 3.6e-7.
constexpr float kBoundMargin = 1.000001F;

// The query relative to the tree's centre, enclosed by floats.
struct QueryBox {
  float lower[3], upper[3];
  QueryBox(const FacetTree& tree, const Vec3& query_mm) {
    for (int axis = 0; axis < 3; ++axis) {
      const double local = query_mm[axis] - tree.centre_mm[axis];
      const auto rounded = static_cast<float>(local);
      lower[axis] = rounded - std::abs(rounded) * 1.2e-7F;  // 2^-23: an ulp
      upper[axis] = rounded + std::abs(rounded) * 1.2e-7F;
    }
  }
};

// Squared lower bounds of the distances to the node's children, and the children within `bound`.
HWY_ATTR HWY_INLINE std::uint32_t test_boxes(const FacetTreeNode& node, const QueryBox& query,
                                             float bound_squared, float* lower_squared) {
  const Lanes8 d;
  const auto bound = hn::Set(d, bound_squared);
  std::uint32_t within = 0;
  for (std::size_t i = 0; i < kTreeWidth; i += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const auto below = hn::Sub(hn::Load(d, node.lower[axis] + i), hn::Set(d, query.upper[axis]));
      const auto above = hn::Sub(hn::Set(d, query.lower[axis]), hn::Load(d, node.upper[axis] + i));
      const auto gap = hn::Max(hn::Max(below, above), hn::Zero(d));
      sum = hn::MulAdd(gap, gap, sum);
    }
    hn::Store(sum, d, lower_squared + i);
    std::uint8_t bits = 0;
    hn::StoreMaskBits(d, hn::Le(sum, bound), &bits);
    within |= static_cast<std::uint32_t>(bits) << i;
  }
  return within & ((1U << node.children) - 1U);
}

// Squared float distances of the query (relative to the leaf's centre) to the leaf's facets.
HWY_ATTR HWY_INLINE void test_leaf(const FacetTreeLeaf& leaf, const float* query, float* distance_squared) {
  const Lanes8 d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const auto qx = hn::Set(d, query[0]), qy = hn::Set(d, query[1]), qz = hn::Set(d, query[2]);
  for (std::size_t i = 0; i < kTreeWidth; i += hn::Lanes(d)) {
    const auto along = [&](const float(&direction)[3][kTreeWidth], const float* offset) HWY_ATTR {
      auto sum = hn::MulSub(hn::Load(d, direction[0] + i), qx, hn::Load(d, offset + i));
      sum = hn::MulAdd(hn::Load(d, direction[1] + i), qy, sum);
      return hn::MulAdd(hn::Load(d, direction[2] + i), qz, sum);
    };
    const auto x = along(leaf.u, leaf.origin[0]), y = along(leaf.v, leaf.origin[1]),
               z = along(leaf.w, leaf.origin[2]);
    const auto a = hn::Load(d, leaf.a + i), b = hn::Load(d, leaf.b + i), h = hn::Load(d, leaf.height + i);

    // Edge AB, the line y = -h from x = a to x = b.
    const auto above = hn::Add(y, h);
    const auto beside = hn::Sub(x, hn::Min(hn::Max(x, a), b));
    auto nearest = hn::MulAdd(beside, beside, hn::Mul(above, above));
    // Edges CA and CB, t (a, -h) and t (b, -h) with t in [0, 1].
    const auto yh = hn::Mul(y, h);
    const auto to_edge = [&](const auto& end, const float* inverse_length2) HWY_ATTR {
      const auto reach = hn::Mul(hn::MulSub(x, end, yh), hn::Load(d, inverse_length2 + i));
      const auto t = hn::Min(hn::Max(reach, zero), one);
      const auto dx = hn::NegMulAdd(t, end, x), dy = hn::MulAdd(t, h, y);
      return hn::MulAdd(dx, dx, hn::Mul(dy, dy));
    };
    nearest = hn::Min(nearest, hn::Min(to_edge(a, leaf.inverse_ca2), to_edge(b, leaf.inverse_cb2)));
    // Inside the three edges the distance in the plane is zero. xh = x h; CA: x h + y a >= 0, CB: x h + y b
    // <= 0.
    const auto xh = hn::Mul(x, h);
    const auto inside = hn::Min(above, hn::Min(hn::MulAdd(y, a, xh), hn::Neg(hn::MulAdd(y, b, xh))));
    nearest = hn::IfThenElse(hn::Ge(inside, zero), zero, nearest);
    hn::Store(hn::MulAdd(z, z, nearest), d, distance_squared + i);
  }
}

// One query's search: the best answer so far, and what is known about everything outside its leaf.
struct Search {
  const FacetTree& tree;
  const Vec3& query;
  ClosestPointWork& work;
  ClosestPoint best{};
  std::uint32_t best_leaf = kNoFacet;
  double best_leaf_lower = 0.0;                              // of the distance to the best leaf
  double outside = std::numeric_limits<double>::infinity();  // lower bound of what other leaves hold

  HWY_ATTR void visit_leaf(std::uint32_t number) {
    const FacetTreeLeaf& leaf = tree.leaves[number];
    float local[3];
    float reach = leaf.radius_mm;
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = static_cast<float>(query[axis] - leaf.centre_mm[axis]);
      reach += std::abs(local[axis]);
    }
    alignas(32) float distance_squared[kTreeWidth];
    test_leaf(leaf, local, distance_squared);
    work.facets_tested += leaf.facets;
    const double error = kFloatError * reach;
    float least = distance_squared[0];
    for (std::uint32_t lane = 1; lane < kTreeWidth; ++lane) least = std::min(least, distance_squared[lane]);
    const double lower = std::sqrt(static_cast<double>(least)) - error;
    bool improved = false;
    for (std::uint32_t lane = 0; lane < leaf.facets; ++lane) {
      const double reachable = best.distance_mm + error;
      if (distance_squared[lane] <= reachable * reachable) improved |= measure(number * kTreeWidth + lane);
    }
    if (improved) {
      if (best_leaf != kNoFacet) outside = std::min(outside, best_leaf_lower);
      best_leaf = number;
      best_leaf_lower = lower;
    } else {
      outside = std::min(outside, lower);
    }
  }

  bool measure(std::uint32_t place) {
    const auto& [a, b, c] = tree.corners_mm[place];
    const FacetPoint candidate = closest_point_on_facet(a, b, c, query);
    const double distance = (query - candidate.point_mm).norm();
    const std::uint32_t facet = tree.facet[place];
    if (distance > best.distance_mm || (distance == best.distance_mm && facet >= best.facet)) return false;
    best = {candidate.point_mm, distance, facet, candidate.feature};
    return true;
  }

  // Everything not visited is farther than the best by more than `slack`.
  HWY_ATTR void run(std::uint32_t seed_leaf, double slack) {
    struct Pending {
      float lower_squared;
      std::uint32_t child;
    };
    Pending stack[64 * kTreeWidth];
    std::size_t depth = 0;
    const QueryBox box(tree, query);
    if (seed_leaf != kNoFacet) visit_leaf(seed_leaf);
    stack[depth++] = {0.0F, 0};
    const auto bound_squared = [&] {
      const double bound = best.distance_mm + slack;
      return bound < 1e18 ? static_cast<float>(bound * bound) * kBoundMargin
                          : std::numeric_limits<float>::infinity();
    };
    while (depth > 0) {
      const Pending next = stack[--depth];
      if (next.lower_squared > bound_squared()) continue;
      if (next.child & kLeafFlag) {
        if ((next.child ^ kLeafFlag) != seed_leaf) visit_leaf(next.child ^ kLeafFlag);
        continue;
      }
      const FacetTreeNode& node = tree.nodes[next.child];
      work.boxes_tested += node.children;
      alignas(32) float lower_squared[kTreeWidth];
      std::uint32_t within = test_boxes(node, box, bound_squared(), lower_squared);
      const std::size_t base = depth;
      for (; within != 0; within &= within - 1) {
        const int k = std::countr_zero(within);
        std::size_t at = depth++;  // nearest last
        for (; at > base && stack[at - 1].lower_squared < lower_squared[k]; --at) stack[at] = stack[at - 1];
        stack[at] = {lower_squared[k], node.child[k]};
      }
    }
    outside = std::min(outside, best.distance_mm + slack);
  }
};

// The answer from the cached leaf alone, if it certainly holds the closest point.
HWY_ATTR bool answer_from_cache(const FacetTree& tree, const Vec3& query, const CertifiedCache& known,
                                ClosestPoint& closest, ClosestPointWork& work) {
  if (known.lower_bound_mm < 0.0) return false;
  Search search{tree, query, work};
  search.visit_leaf(known.leaf);
  if (search.best.distance_mm >= known.lower_bound_mm - (query - known.anchor_mm).norm()) return false;
  closest = search.best;
  return true;
}

HWY_ATTR void SearchAll(const FacetTree& tree, std::span<const Vec3> queries_mm, std::uint32_t seed_leaf,
                        std::span<ClosestPoint> closest, std::span<CertifiedCache> cache,
                        ClosestPointWork& work) {
  work.queries += queries_mm.size();
  for (std::size_t i = 0; i < queries_mm.size(); ++i) {
    const Vec3& query = queries_mm[i];
    double slack = 0.0;
    if (!cache.empty()) {
      if (answer_from_cache(tree, query, cache[i], closest[i], work)) {
        ++work.cache_hits;
        seed_leaf = cache[i].leaf;
        continue;
      }
      if (cache[i].lower_bound_mm >= 0.0) {
        seed_leaf = cache[i].leaf;
        slack = (query - cache[i].anchor_mm).norm();
      } else if (seed_leaf != kNoFacet) {
        slack = 0.1 * tree.leaves[seed_leaf].radius_mm;
      }
    }
    Search search{tree, query, work};
    search.run(seed_leaf, slack);
    closest[i] = search.best;
    seed_leaf = search.best_leaf;
    // 1e-12: the bound is used with rounded distances and motions.
    if (!cache.empty()) cache[i] = {query, search.outside * (1.0 - 1e-12), search.best_leaf};
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trueblade {

HWY_EXPORT(SearchAll);

void search_facet_tree(const FacetTree& tree, std::span<const Vec3> queries_mm, std::uint32_t seed_leaf,
                       std::span<ClosestPoint> closest, std::span<CertifiedCache> cache,
                       ClosestPointWork& work) {
  HWY_DYNAMIC_DISPATCH(SearchAll)(tree, queries_mm, seed_leaf, closest, cache, work);
}

}  // namespace trueblade
#endif
