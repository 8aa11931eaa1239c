// Search of a FacetTree, compiled for every instruction set of the machine's family and dispatched at run
// time.
#pragma once

#include <span>

#include "geometry/closest_point_tree.h"
#include "geometry/facet_tree.h"

namespace trueblade {

// closest[i] for queries_mm[i]; `seed_leaf` starts the first query (kNoFacet: none). `cache` is empty or one
// per query. Adds to `work`.
void search_facet_tree(const FacetTree& tree, std::span<const Vec3> queries_mm, std::uint32_t seed_leaf,
                       std::span<ClosestPoint> closest, std::span<CertifiedCache> cache,
                       ClosestPointWork& work);

}  // namespace trueblade
