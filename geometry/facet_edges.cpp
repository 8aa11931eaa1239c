#include "geometry/facet_edges.h"

#include <algorithm>

namespace trueblade {

FacetEdges::FacetEdges(std::span<const std::array<std::uint32_t, 3>> facets, std::size_t node_count) {
  struct Record {
    std::uint32_t higher_node;
    EdgeUse use;
  };

  // Counting sort by the lower node, then each node's few edges by the higher node.
  std::vector<std::size_t> first_of_node(node_count + 1, 0);
  for (const auto& nodes : facets)
    for (int k = 0; k < 3; ++k) ++first_of_node[std::min(nodes[k], nodes[(k + 1) % 3]) + 1];
  for (std::size_t node = 0; node < node_count; ++node) first_of_node[node + 1] += first_of_node[node];

  std::vector<Record> records(3 * facets.size());
  std::vector<std::size_t> end_of_node(first_of_node.begin(), first_of_node.end() - 1);
  for (std::uint32_t facet = 0; facet < facets.size(); ++facet) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t from = facets[facet][k], to = facets[facet][(k + 1) % 3];
      records[end_of_node[std::min(from, to)]++] = {std::max(from, to), {facet, k, from < to}};
    }
  }

  uses_.reserve(records.size());
  first_use_.push_back(0);
  for (std::size_t node = 0; node < node_count; ++node) {
    const auto begin = records.begin() + static_cast<std::ptrdiff_t>(first_of_node[node]);
    const auto end = records.begin() + static_cast<std::ptrdiff_t>(first_of_node[node + 1]);
    std::sort(begin, end, [](const Record& a, const Record& b) {
      return a.higher_node != b.higher_node ? a.higher_node < b.higher_node : a.use.facet < b.use.facet;
    });
    for (auto record = begin; record != end; ++record) {
      uses_.push_back(record->use);
      if (record + 1 == end || (record + 1)->higher_node != record->higher_node)
        first_use_.push_back(uses_.size());
    }
  }
}

}  // namespace trueblade
