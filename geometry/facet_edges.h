// The edges of a list of facets: which facets meet in the segment between two nodes, and in which direction
// each runs along it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace trueblade {

struct EdgeUse {
  std::uint32_t facet;
  std::uint8_t edge;  // edge k of the facet joins its corners k and k+1 (mod 3)
  bool forward;       // the facet runs from the lower node number to the higher
};

// An edge is a number in [0, size()); edges are ordered by their lower, then their higher node number, the
// uses of an edge by facet.
class FacetEdges {
 public:
  // Precondition: node numbers below node_count, three different ones in each facet. Cost n log n.
  FacetEdges(std::span<const std::array<std::uint32_t, 3>> facets, std::size_t node_count);

  std::size_t size() const { return first_use_.size() - 1; }
  std::span<const EdgeUse> uses(std::size_t edge) const {
    return {uses_.data() + first_use_[edge], first_use_[edge + 1] - first_use_[edge]};
  }

 private:
  std::vector<EdgeUse> uses_;
  std::vector<std::size_t> first_use_;
};

}  // namespace trueblade
