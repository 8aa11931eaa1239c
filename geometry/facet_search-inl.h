// Search of the tree for one query. Included once per instruction set.
#if defined(TRUEBLADE_FACET_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRUEBLADE_FACET_SEARCH_INL_H
#undef TRUEBLADE_FACET_SEARCH_INL_H
#else
#define TRUEBLADE_FACET_SEARCH_INL_H
#endif

#include <bit>

#include "geometry/closest_point_tree.h"
#include "geometry/facet_measurement-inl.h"
#include "geometry/leaf_distances-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Facets of one query that float cannot tell apart wait in a list of this length.
constexpr std::uint32_t kCandidates = 12;

// What one query has found so far.
struct Member {
  std::uint32_t query = 0;
  std::uint32_t candidates = 0;
  float upper = std::numeric_limits<float>::max();  // the closest point is at most this far
  float slack = 0.0F;  // everything within upper + slack is looked at: it makes the certificate last
  // For the certificate: the nearest facet so far, and lower bounds of what is farther.
  std::uint32_t best_place = kNoFacet;
  float best_leaf_lower = 0.0F;                            // of the best facet's leaf
  float second_lower = 0.0F;                               // of that leaf without the best facet
  float outside = std::numeric_limits<float>::infinity();  // of all other leaves
  // Facets that float cannot exclude: places, squared distances and their errors.
  std::uint32_t place[kCandidates];
  float squared[kCandidates], error[kCandidates];

  float bound_squared() const {
    const float bound = upper + slack;
    return bound * bound * (1.0F + kSquareError);
  }
  bool possible(std::uint32_t k) const {
    const float limit = upper + error[k];
    return squared[k] <= limit * limit;
  }
};

// Takes in a facet that may be the closest; when the list is full, those that no longer may be leave it.
HWY_ATTR HWY_INLINE void add_candidate(Member& member, std::uint32_t place, float squared, float error,
                                       Measurement& measurement) {
  if (member.candidates == kCandidates) {
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < kCandidates; ++k) {
      if (!member.possible(k)) continue;
      member.place[kept] = member.place[k];
      member.squared[kept] = member.squared[k];
      member.error[kept++] = member.error[k];
    }
    if (kept == kCandidates) {
      for (std::uint32_t k = 0; k < kCandidates; ++k) measurement.add(member.query, member.place[k]);
      kept = 0;
    }
    member.candidates = kept;
  }
  member.place[member.candidates] = place;
  member.squared[member.candidates] = squared;
  member.error[member.candidates++] = error;
}

HWY_ATTR HWY_INLINE void measure_candidates(const Member& member, Measurement& measurement) {
  for (std::uint32_t k = 0; k < member.candidates; ++k)
    if (member.possible(k)) measurement.add(member.query, member.place[k]);
}

// Tests the facets of a leaf; kCertify also keeps what the certificate needs.
template <bool kCertify>
HWY_ATTR HWY_INLINE void visit_leaf(const FacetTree& tree, std::uint32_t number, const Vec3& query_mm,
                                    Member& member, Measurement& measurement) {
  const FacetTreeLeaf& leaf = tree.leaves[number];
  LeafDistances distances;
  test_leaf(leaf, query_mm, distances);
  const float limit = member.upper + distances.error;
  if (!kCertify && distances.least_squared > limit * limit) return;
  const float least = std::sqrt(distances.least_squared);
  const float lower = least - distances.error, upper = least + distances.error;
  const bool improved = upper < member.upper;
  if (kCertify) {
    if (improved) {
      if (member.best_place != kNoFacet) member.outside = std::min(member.outside, member.best_leaf_lower);
      member.best_leaf_lower = lower;
    } else {
      member.outside = std::min(member.outside, lower);
    }
    if (!(lower <= member.upper)) return;
  }
  member.upper = std::min(member.upper, upper);
  const float reach = member.upper + distances.error;
  std::uint32_t within = lanes_within(leaf, distances, reach * reach);
  const std::uint32_t first = number * kTreeWidth;
  if (improved) {
    const auto best =
        static_cast<std::uint32_t>(std::countr_zero(lanes_within(leaf, distances, distances.least_squared)));
    member.best_place = first + best;
    if (kCertify) member.second_lower = std::sqrt(second_least_squared(distances, best)) - distances.error;
  }
  for (; within != 0; within &= within - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(within));
    add_candidate(member, first + lane, distances.squared[lane], distances.error, measurement);
  }
}

// A float copy of the query relative to the tree's centre, enclosed.
struct FloatPoint {
  float lower[3], upper[3];
  FloatPoint() = default;
  HWY_ATTR FloatPoint(const FacetTree& tree, const Vec3& point_mm) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto x = static_cast<float>(point_mm[axis] - tree.centre_mm[axis]);
      lower[axis] = x - std::abs(x) * kUlp;
      upper[axis] = x + std::abs(x) * kUlp;
    }
  }
};

// Walks down the tree, the nearest child first. `bound_squared()` is asked for the present reach,
// `visit(leaf)` called for every leaf within.
template <class Bound, class Visit>
HWY_ATTR HWY_INLINE void descend(const FacetTree& tree, const FloatPoint& point, ClosestPointWork& work,
                                 const Bound& bound_squared, const Visit& visit) {
  struct Pending {
    float lower_squared;
    std::uint32_t child;
  };
  const Floats d;
  Pending stack[32 * kTreeWidth];  // at most seven more than are taken off wait on each level
  std::size_t depth = 0;
  std::uint32_t number = 0;
  for (;;) {
    const FacetTreeNode& node = tree.nodes[number];
    work.boxes_tested += node.children;
    alignas(32) float lower_squared[kTreeWidth];
    const auto bound = hn::Set(d, bound_squared());
    std::uint32_t within = 0;
    for (std::size_t i = 0; i < kTreeWidth; i += hn::Lanes(d)) {
      auto sum = hn::Zero(d);
      for (int axis = 0; axis < 3; ++axis) {
        const auto below = hn::Sub(hn::Load(d, node.lower[axis] + i), hn::Set(d, point.upper[axis]));
        const auto above = hn::Sub(hn::Set(d, point.lower[axis]), hn::Load(d, node.upper[axis] + i));
        const auto gap = hn::Max(hn::Max(below, above), hn::Zero(d));
        sum = hn::MulAdd(gap, gap, sum);
      }
      hn::Store(sum, d, lower_squared + i);
      std::uint8_t bits = 0;
      hn::StoreMaskBits(d, hn::Le(sum, bound), &bits);
      within |= static_cast<std::uint32_t>(bits) << i;
    }
    within &= (1U << node.children) - 1U;
    const std::size_t base = depth;
    for (; within != 0; within &= within - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(within));
      std::size_t at = depth++;
      for (; at > base && stack[at - 1].lower_squared < lower_squared[slot]; --at) stack[at] = stack[at - 1];
      stack[at] = {lower_squared[slot], node.child[slot]};
    }
    for (;;) {
      if (depth == 0) return;
      const Pending& next = stack[--depth];
      if (next.lower_squared > bound_squared()) continue;
      if (!(next.child & kLeafFlag)) {
        number = next.child;
        break;
      }
      visit(next.child ^ kLeafFlag);
    }
  }
}

// One query by itself.
template <bool kCertify>
HWY_ATTR void search_one(const FacetTree& tree, const Vec3& query_mm, std::uint32_t seed_leaf, Member& member,
                         Measurement& measurement, ClosestPointWork& work) {
  const auto visit = [&](std::uint32_t leaf) HWY_ATTR {
    work.facets_tested += kTreeWidth;
    visit_leaf<kCertify>(tree, leaf, query_mm, member, measurement);
  };
  if (seed_leaf != kNoFacet) visit(seed_leaf);
  descend(
      tree, FloatPoint(tree, query_mm), work, [&]() HWY_ATTR { return member.bound_squared(); },
      [&](std::uint32_t leaf) HWY_ATTR {
        if (leaf != seed_leaf) visit(leaf);
      });
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#endif
