#include "geometry/facet_tree_search.h"

#include <algorithm>
#include <cmath>

// Highway compiles this file once for every instruction set and picks the machine's best at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/facet_tree_search.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "geometry/facet_measurement-inl.h"
#include "geometry/facet_search-inl.h"
#include "geometry/group_search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A group pays from this many queries on, and while it is no wider than a leaf: then most of what is in reach
// of one is in reach of all.
constexpr std::size_t kLeastGroup = 4;
// The first certificate of a query lasts for a motion of a tenth of a leaf (for 6 to 20 % of the search's
// time); a renewed one for the motion that used up the last, because the steps of a registration shrink.
constexpr float kFirstSlack = 0.1F;

constexpr std::size_t kCacheLine = 64;  // bytes; of other lengths some lines come without being asked for

// A query that still needs a search.
struct OpenQuery {
  std::uint32_t query;
  float slack;  // the motion that its certificate should outlast
};

// The range of queries in work, and the search structures around it.
struct Block {
  const FacetTree& tree;
  const Vec3* queries_mm;
  CertifiedCache* cache;  // nullptr: none
  Measurement& measurement;
  ClosestPointWork& work;
  std::uint32_t& seed_leaf;  // where the last answer was found
};

HWY_ATTR float motion_since(const FacetTree& tree, const CertifiedCache& known, const Vec3& query_mm) {
  float squared = 0.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const auto moved = static_cast<float>(query_mm[axis] - tree.centre_mm[axis] -
                                          static_cast<double>(known.anchor_mm[axis]));
    squared += moved * moved;
  }
  return std::sqrt(squared) * (1.0F + kSquareError);
}

// Renews the certificate: `outside` bounds the distance to all other leaves, `second` to the other facets of
// the leaf.
HWY_ATTR void certify(const FacetTree& tree, const Vec3& query_mm, std::uint32_t place, float outside,
                      float second, CertifiedCache& known) {
  float rounding = 0.0F;  // of the anchor
  for (int axis = 0; axis < 3; ++axis) {
    known.anchor_mm[axis] = static_cast<float>(query_mm[axis] - tree.centre_mm[axis]);
    rounding += std::abs(known.anchor_mm[axis]) * kUlp;
  }
  known.place = place;
  known.leaf_bound_mm = place == kNoFacet ? -1.0F : outside - rounding;
  known.facet_bound_mm = std::min(known.leaf_bound_mm, second - rounding);
}

template <bool kCertify>
HWY_ATTR void search_alone(const Block& block, const OpenQuery& open) {
  const Vec3& query_mm = block.queries_mm[open.query];
  Member member;
  member.query = open.query;
  member.slack = open.slack;
  search_one<kCertify>(block.tree, query_mm, block.seed_leaf, member, block.measurement, block.work);
  measure_candidates(member, block.measurement);
  if (member.best_place != kNoFacet) block.seed_leaf = member.best_place / kTreeWidth;
  if (kCertify)
    certify(block.tree, query_mm, member.best_place, std::min(member.outside, member.upper + member.slack),
            member.second_lower, block.cache[open.query]);
}

// False when the group must be searched one by one.
template <bool kCertify>
HWY_ATTR bool search_group(const Block& block, const OpenQuery* open, std::size_t size, const Ball& ball) {
  float slack = 0.0F;
  for (std::size_t m = 0; m < size; ++m) slack = std::max(slack, open[m].slack);
  ReachedLeaves reached;
  if (!reach_leaves(block.tree, ball, slack, block.seed_leaf, reached, block.work)) return false;
  GroupDistances group;
  for (std::size_t m = 0; m < kGroup; ++m) {  // the last query fills the vectors
    const Vec3 local = block.queries_mm[open[std::min(m, size - 1)].query] - ball.centre_mm;
    group.x[m] = static_cast<float>(local[0]);
    group.y[m] = static_cast<float>(local[1]);
    group.z[m] = static_cast<float>(local[2]);
  }
  search_together(block.tree, ball, slack, reached, size, group, block.work);
  for (std::size_t m = 0; m < size; ++m) {
    const std::uint32_t query = open[m].query;
    const auto place = static_cast<std::uint32_t>(group.best_place[m]);
    if (group.unclear >> m & 1U)
      search_reached(block.tree, block.queries_mm[query], query, reached, group.upper[m], block.measurement,
                     block.work);
    else
      block.measurement.add(query, place);
    if (kCertify)
      certify(block.tree, block.queries_mm[query], place,
              std::min(group.outside[m], group.lower[m] + open[m].slack), group.second_lower[m],
              block.cache[query]);
  }
  block.seed_leaf = static_cast<std::uint32_t>(group.best_place[size - 1]) / kTreeWidth;
  return true;
}

// Searches the open queries: neighbours together, others alone.
template <bool kCertify>
HWY_ATTR void search(const Block& block, const OpenQuery* open, std::size_t count) {
  for (std::size_t first = 0; first < count;) {
    if (kCertify && block.cache[open[first].query].leaf_bound_mm >= 0.0F)
      block.seed_leaf = block.cache[open[first].query].place / kTreeWidth;
    std::size_t size = 1;
    if (block.seed_leaf != kNoFacet) {
      Vec3 lower = block.queries_mm[open[first].query], upper = lower;
      const double widest = block.tree.leaves[block.seed_leaf].radius_mm;
      for (; size < kGroup && first + size < count; ++size) {
        const Vec3& next = block.queries_mm[open[first + size].query];
        const Vec3 low = lower.cwiseMin(next), high = upper.cwiseMax(next);
        if (!((high - low).maxCoeff() <= widest)) break;
        lower = low;
        upper = high;
      }
      const auto radius = static_cast<float>(0.5 * (upper - lower).norm()) * (1.0F + kSquareError);
      // A query that is not finite makes no ball: it goes alone.
      if (size >= kLeastGroup && std::isfinite(radius) &&
          search_group<kCertify>(block, open + first, size, {0.5 * (lower + upper), radius})) {
        first += size;
        continue;
      }
    }
    for (const std::size_t end = first + size; first < end; ++first)
      search_alone<kCertify>(block, open[first]);
  }
}

// Asks for the cache lines of `bytes` from `first` on. A model finer than the processor's caches keeps a
// query waiting for memory most of its time; asked for together, the lines of a block come while others are
// worked on.
HWY_ATTR HWY_INLINE void prefetch(const void* first, std::size_t bytes) {
  for (std::size_t line = 0; line < bytes; line += kCacheLine)
    hwy::Prefetch(static_cast<const char*>(first) + line);
}

// True when the certificate proves that the leaf of the cached facet, which is `nearest` by now, holds the
// closest.
HWY_ATTR bool answers_from_leaf(const Block& block, const ClosestPoint& nearest, std::uint32_t query,
                                float motion) {
  const CertifiedCache& cache = block.cache[query];
  Member member;
  member.query = query;
  member.upper = static_cast<float>(nearest.distance_mm) * (1.0F + kUlp);
  block.work.facets_tested += kTreeWidth;
  visit_leaf<false>(block.tree, cache.place / kTreeWidth, block.queries_mm[query], member, block.measurement);
  if (!(member.upper < cache.leaf_bound_mm - motion)) return false;
  measure_candidates(member, block.measurement);
  return true;
}

// Answers what the certificates allow, first from the facet alone, then from its leaf; returns the number of
// queries left open.
HWY_ATTR std::size_t answer_from_cache(const Block& block, ClosestPoint* closest, std::size_t count,
                                       OpenQuery* open) {
  const auto known = [&](std::size_t i) { return block.cache[i].leaf_bound_mm >= 0.0F; };
  for (std::size_t i = 0; i < count; ++i)
    if (known(i)) {
      prefetch(&block.tree.records[block.cache[i].place], sizeof(FacetRecord));
      block.measurement.add(static_cast<std::uint32_t>(i), block.cache[i].place);
    }
  block.measurement.measure();

  const std::uint32_t any_leaf = block.seed_leaf == kNoFacet ? 0 : block.seed_leaf;
  const float first_slack = kFirstSlack * block.tree.leaves[any_leaf].radius_mm;
  std::size_t unanswered = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto query = static_cast<std::uint32_t>(i);
    if (!known(i)) {
      open[unanswered++] = {query, first_slack};
      continue;
    }
    const CertifiedCache& cache = block.cache[i];
    const float motion = motion_since(block.tree, cache, block.queries_mm[i]);
    if (closest[i].distance_mm < static_cast<double>(cache.facet_bound_mm - motion)) {
      ++block.work.facets_tested;
      ++block.work.cache_hits;
    } else {
      prefetch(&block.tree.leaves[cache.place / kTreeWidth], sizeof(FacetTreeLeaf));
      open[unanswered++] = {query, motion};
    }
  }

  std::size_t left = 0;
  for (std::size_t k = 0; k < unanswered; ++k) {
    const auto [query, motion] = open[k];
    if (known(query) && answers_from_leaf(block, closest[query], query, motion))
      ++block.work.cache_hits;
    else
      open[left++] = open[k];
  }
  return left;
}

HWY_ATTR void SearchAll(const FacetTree& tree, std::span<const Vec3> queries_mm, std::uint32_t seed_leaf,
                        std::span<ClosestPoint> closest, std::span<CertifiedCache> cache,
                        ClosestPointWork& work) {
  work.queries += queries_mm.size();
  for (std::size_t begin = 0; begin < queries_mm.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, queries_mm.size() - begin);
    Measurement measurement(tree, &queries_mm[begin], &closest[begin], count);
    OpenQuery open[kBlock];
    if (cache.empty()) {
      for (std::uint32_t i = 0; i < count; ++i) open[i] = {i, 0.0F};
      search<false>({tree, &queries_mm[begin], nullptr, measurement, work, seed_leaf}, open, count);
    } else {
      const Block block{tree, &queries_mm[begin], &cache[begin], measurement, work, seed_leaf};
      search<true>(block, open, answer_from_cache(block, &closest[begin], count, open));
    }
    measurement.measure();
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
