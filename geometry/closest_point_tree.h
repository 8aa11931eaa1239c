// Exact closest point on a facet model, in double: a wide bounding-volume tree whose boxes are stored in
// float, rounded outward, over leaves of a few facets in double. The answer's distance is that of the brute
// force, to rounding.
//
// Immutable after construction; queries are const and may run from any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/closest_point.h"

namespace trueblade {

// What a batch of queries cost, for the comparison tables.
struct ClosestPointWork {
  std::uint64_t queries = 0;
  std::uint64_t cache_hits = 0;  // answered from the point's own cache without a search
  std::uint64_t facets_tested = 0;
  std::uint64_t boxes_tested = 0;
};

// The certified cached facet of one moving query point: the paper's cache (section 3.1), made exact. While
// distance(facet) < facet_bound - motion, the cached facet certainly is the closest; while distance(leaf) <
// leaf_bound - motion, its leaf certainly holds the closest; motion is how far the point is from the anchor.
// Opaque to callers: a default one is empty, the query fills it.
struct CertifiedCache {
  float anchor_mm[3] = {};  // where the point was when the bounds were set, relative to the tree's centre
  float facet_bound_mm = -1.0F;  // distance from the anchor to every other facet, at least
  float leaf_bound_mm = -1.0F;   // distance from the anchor to every other leaf, at least; negative: empty
  std::uint32_t place = 0;       // of the facet in the tree
};

class ClosestPointTree {
 public:
  // Builds over all facets, or over the facets listed (best fit on selected surfaces). Uses TBB; the result
  // does not depend on the number of threads.
  explicit ClosestPointTree(const FacetModel& model);
  ClosestPointTree(const FacetModel& model, std::span<const std::uint32_t> facets);
  ~ClosestPointTree();
  ClosestPointTree(ClosestPointTree&&) noexcept;
  ClosestPointTree& operator=(ClosestPointTree&&) noexcept;

  // One query. `warm_facet`, the facet of a nearby earlier answer, only makes it faster; kNoFacet for none.
  ClosestPoint query(const Vec3& query_mm, std::uint32_t warm_facet = kNoFacet) const;

  // A batch, one thread, in order: closest[i] for queries_mm[i]. `cache` is empty (no caching) or one entry
  // per query, kept by the caller from call to call while the points move. Adds to `work`.
  void query(std::span<const Vec3> queries_mm, std::span<ClosestPoint> closest,
             std::span<CertifiedCache> cache, ClosestPointWork& work) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trueblade
