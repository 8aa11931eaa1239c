#include "geometry/closest_point_tree.h"

#include <numeric>

#include "geometry/error.h"
#include "geometry/facet_tree.h"
#include "geometry/facet_tree_search.h"

namespace trueblade {
namespace {

std::vector<std::uint32_t> all_facets(const FacetModel& model) {
  std::vector<std::uint32_t> facets(model.facet_count());
  std::iota(facets.begin(), facets.end(), 0U);
  return facets;
}

}  // namespace

struct ClosestPointTree::Impl {
  FacetTree tree;
};

ClosestPointTree::ClosestPointTree(const FacetModel& model) : ClosestPointTree(model, all_facets(model)) {}
ClosestPointTree::ClosestPointTree(const FacetModel& model, std::span<const std::uint32_t> facets)
    : impl_(new Impl{build_facet_tree(model, facets)}) {}
ClosestPointTree::~ClosestPointTree() = default;
ClosestPointTree::ClosestPointTree(ClosestPointTree&&) noexcept = default;
ClosestPointTree& ClosestPointTree::operator=(ClosestPointTree&&) noexcept = default;

ClosestPoint ClosestPointTree::query(const Vec3& query_mm, std::uint32_t warm_facet) const {
  const FacetTree& tree = impl_->tree;
  const std::uint32_t place =
      warm_facet < tree.place_of_facet.size() ? tree.place_of_facet[warm_facet] : kNoFacet;
  const std::uint32_t seed_leaf = place == kNoFacet ? kNoFacet : place / kTreeWidth;
  ClosestPoint closest;
  ClosestPointWork work;
  search_facet_tree(tree, {&query_mm, 1}, seed_leaf, {&closest, 1}, {}, work);
  return closest;
}

void ClosestPointTree::query(std::span<const Vec3> queries_mm, std::span<ClosestPoint> closest,
                             std::span<CertifiedCache> cache, ClosestPointWork& work) const {
  if (closest.size() != queries_mm.size() || (!cache.empty() && cache.size() != queries_mm.size()))
    throw InputError("closest-point query: " + std::to_string(queries_mm.size()) + " queries, but " +
                     std::to_string(closest.size()) + " answers and " + std::to_string(cache.size()) +
                     " caches");
  search_facet_tree(impl_->tree, queries_mm, kNoFacet, closest, cache, work);
}

}  // namespace trueblade
