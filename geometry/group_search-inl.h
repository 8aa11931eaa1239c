// Search of the tree for a group of neighbouring queries at once: they go down the tree as the ball around
// them, and each facet in reach is tested for all of them together. Included once per instruction set.
#if defined(TRUEBLADE_GROUP_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRUEBLADE_GROUP_SEARCH_INL_H
#undef TRUEBLADE_GROUP_SEARCH_INL_H
#else
#define TRUEBLADE_GROUP_SEARCH_INL_H
#endif

#include "geometry/facet_search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kGroup = 16;     // queries of a group
constexpr std::size_t kReached = 48;   // leaves within a group's reach
constexpr std::size_t kWaiting = 192;  // nodes and leaves met on the way

using GroupFloats = hn::CappedTag<float, kGroup>;
using GroupFloat = hn::Vec<GroupFloats>;

struct Ball {
  Vec3 centre_mm;
  float radius_mm;
};

// The leaves within reach of the queries of a ball, and the distances of its centre to their facets.
struct ReachedLeaves {
  std::size_t count = 0;
  std::uint32_t leaf[kReached];
  LeafDistances of_centre[kReached];
  float centre_upper = 0.0F;  // upper bound of the centre's distance to the closest facet
  float error = 0.0F;  // bounds the error of any float distance between a query of the ball and these leaves
};

// Breadth first, without a branch that depends on the order of the boxes. A query of the ball is at most d +
// radius from the closest facet, d being the centre's distance, so that all that matters is within d + 2
// radius + slack of the centre; d starts from the seed leaf. False when too many leaves are in reach: the
// seed is far off, or the group is far from the part.
HWY_ATTR bool reach_leaves(const FacetTree& tree, const Ball& ball, float slack, std::uint32_t seed_leaf,
                           ReachedLeaves& reached, ClosestPointWork& work) {
  const Floats d;
  const hn::Repartition<std::uint32_t, Floats> du;
  LeafDistances distances;
  test_leaf(tree.leaves[seed_leaf], ball.centre_mm, distances);
  float upper = std::sqrt(distances.least_squared) + distances.error;
  const float margin = 2.0F * ball.radius_mm + slack;
  const float bound = upper + margin;
  const auto bound_squared = hn::Set(d, bound * bound * (1.0F + kSquareError));
  const FloatPoint centre(tree, ball.centre_mm);

  std::uint32_t waiting[kWaiting + kTreeWidth];
  waiting[0] = 0;
  std::size_t end = 1;
  for (std::size_t next = 0; next < end; ++next) {
    const std::uint32_t child = waiting[next];
    if (child & kLeafFlag) {
      if (reached.count == kReached) return false;
      reached.leaf[reached.count++] = child ^ kLeafFlag;
      continue;
    }
    if (end > kWaiting) return false;
    const FacetTreeNode& node = tree.nodes[child];
    work.boxes_tested += kTreeWidth;
    for (std::size_t i = 0; i < kTreeWidth; i += hn::Lanes(d)) {
      auto sum = hn::Zero(d);
      for (int axis = 0; axis < 3; ++axis) {
        const auto below = hn::Sub(hn::Load(d, node.lower[axis] + i), hn::Set(d, centre.upper[axis]));
        const auto above = hn::Sub(hn::Set(d, centre.lower[axis]), hn::Load(d, node.upper[axis] + i));
        const auto gap = hn::Max(hn::Max(below, above), hn::Zero(d));
        sum = hn::MulAdd(gap, gap, sum);
      }
      end += hn::CompressStore(hn::Load(du, node.child + i), hn::RebindMask(du, hn::Le(sum, bound_squared)),
                               du, waiting + end);
    }
  }
  float error = 0.0F;
  for (std::size_t k = 0; k < reached.count; ++k) {
    test_leaf(tree.leaves[reached.leaf[k]], ball.centre_mm, reached.of_centre[k]);
    upper = std::min(upper, std::sqrt(reached.of_centre[k].least_squared) + reached.of_centre[k].error);
    error = std::max(error, reached.of_centre[k].error);
  }
  work.facets_tested += (reached.count + 1) * kTreeWidth;
  reached.centre_upper = upper;
  reached.error = error + 2.0F * kFloatError * ball.radius_mm;
  return true;
}

// The answers of a group in float: per query the nearest facet and what is farther.
struct GroupDistances {
  alignas(64) float x[kGroup], y[kGroup], z[kGroup];  // queries relative to the ball's centre
  alignas(64) float lower[kGroup], upper[kGroup];     // bounds of the distance to the closest facet
  alignas(64) std::int32_t best_place[kGroup];
  alignas(64) float best_leaf_lower[kGroup], second_lower[kGroup], outside[kGroup];
  std::uint32_t unclear;  // bit per query: more than one facet may be the closest
};

// Squared distance of a vector of queries, relative to the leaf's centre, to one facet of the leaf.
HWY_ATTR HWY_INLINE GroupFloat facet_distance_squared(const FacetTreeLeaf& leaf, std::uint32_t lane,
                                                      GroupFloat qx, GroupFloat qy, GroupFloat qz) {
  const GroupFloats d;
  const auto along = [&](const float(&direction)[3][kTreeWidth], const float* offset) HWY_ATTR {
    auto sum = hn::MulSub(hn::Set(d, direction[0][lane]), qx, hn::Set(d, offset[lane]));
    sum = hn::MulAdd(hn::Set(d, direction[1][lane]), qy, sum);
    return hn::MulAdd(hn::Set(d, direction[2][lane]), qz, sum);
  };
  const FrameFacet<GroupFloat> facet{hn::Set(d, leaf.a[lane]), hn::Set(d, leaf.b[lane]),
                                     hn::Set(d, leaf.height[lane]), hn::Set(d, leaf.inverse_ca2[lane]),
                                     hn::Set(d, leaf.inverse_cb2[lane])};
  return distance_squared_in_frame(d, facet, along(leaf.u, leaf.origin[0]), along(leaf.v, leaf.origin[1]),
                                   along(leaf.w, leaf.origin[2]));
}

HWY_ATTR void search_together(const FacetTree& tree, const Ball& ball, float slack,
                              const ReachedLeaves& reached, std::size_t size, GroupDistances& group,
                              ClosestPointWork& work) {
  const GroupFloats d;
  const hn::Repartition<std::int32_t, GroupFloats> di;
  const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
  const float reach = reached.centre_upper + 2.0F * ball.radius_mm + slack;
  std::uint32_t within[kReached];
  for (std::size_t k = 0; k < reached.count; ++k) {
    const float limit = reach + reached.of_centre[k].error;
    within[k] = lanes_within(tree.leaves[reached.leaf[k]], reached.of_centre[k], limit * limit);
    work.facets_tested += static_cast<std::uint64_t>(std::popcount(within[k])) * size;
  }
  group.unclear = 0;
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    const auto x = hn::Load(d, group.x + i), y = hn::Load(d, group.y + i), z = hn::Load(d, group.z + i);
    auto best = infinite, second = infinite, outside = infinite;
    auto place = hn::Zero(di);
    for (std::size_t k = 0; k < reached.count; ++k) {
      if (within[k] == 0) continue;
      const FacetTreeLeaf& leaf = tree.leaves[reached.leaf[k]];
      const auto qx = hn::Add(x, hn::Set(d, static_cast<float>(ball.centre_mm[0] - leaf.centre_mm[0])));
      const auto qy = hn::Add(y, hn::Set(d, static_cast<float>(ball.centre_mm[1] - leaf.centre_mm[1])));
      const auto qz = hn::Add(z, hn::Set(d, static_cast<float>(ball.centre_mm[2] - leaf.centre_mm[2])));
      auto leaf_best = infinite, leaf_second = infinite;
      auto leaf_place = hn::Zero(di);
      for (std::uint32_t bits = within[k]; bits != 0; bits &= bits - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
        const auto squared = facet_distance_squared(leaf, lane, qx, qy, qz);
        const auto nearer = hn::Lt(squared, leaf_best);
        leaf_second = hn::Min(leaf_second, hn::Max(leaf_best, squared));
        leaf_best = hn::Min(leaf_best, squared);
        leaf_place = hn::IfThenElse(
            hn::RebindMask(di, nearer),
            hn::Set(di, static_cast<std::int32_t>(reached.leaf[k] * kTreeWidth + lane)), leaf_place);
      }
      const auto nearer = hn::Lt(leaf_best, best);
      outside = hn::Min(outside, hn::Max(best, leaf_best));
      second = hn::IfThenElse(nearer, leaf_second, second);
      place = hn::IfThenElse(hn::RebindMask(di, nearer), leaf_place, place);
      best = hn::Min(best, leaf_best);
    }
    const auto error = hn::Set(d, reached.error);
    const auto distance = hn::Sqrt(best);
    const auto upper = hn::Add(distance, error);
    const auto second_lower = hn::Sub(hn::Sqrt(second), error),
               outside_lower = hn::Sub(hn::Sqrt(outside), error);
    hn::Store(hn::Sub(distance, error), d, group.lower + i);
    hn::Store(upper, d, group.upper + i);
    hn::Store(place, di, group.best_place + i);
    hn::Store(second_lower, d, group.second_lower + i);
    hn::Store(outside_lower, d, group.outside + i);
    std::uint8_t bits[2] = {};
    hn::StoreMaskBits(d, hn::Le(hn::Min(second_lower, outside_lower), upper), bits);
    group.unclear |= (bits[0] | static_cast<std::uint32_t>(bits[1]) << 8) << i;
  }
  group.unclear &= (1U << size) - 1U;
}

// One query of the group, of which more than one facet may be the closest: all of them are measured.
HWY_ATTR void search_reached(const FacetTree& tree, const Vec3& query_mm, std::uint32_t query,
                             const ReachedLeaves& reached, float upper, Measurement& measurement,
                             ClosestPointWork& work) {
  Member member;
  member.query = query;
  member.upper = upper;
  for (std::size_t k = 0; k < reached.count; ++k) {
    const FacetTreeLeaf& leaf = tree.leaves[reached.leaf[k]];
    const double reach = static_cast<double>(member.upper + leaf.radius_mm) * (1.0 + kSquareError);
    const Vec3 from_centre(query_mm[0] - leaf.centre_mm[0], query_mm[1] - leaf.centre_mm[1],
                           query_mm[2] - leaf.centre_mm[2]);
    if (from_centre.squaredNorm() > reach * reach) continue;
    work.facets_tested += kTreeWidth;
    visit_leaf<false>(tree, reached.leaf[k], query_mm, member, measurement);
  }
  measure_candidates(member, measurement);
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#endif
