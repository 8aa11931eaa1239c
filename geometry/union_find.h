// Disjoint sets of 0 .. n-1 (path halving; the smaller number becomes the root, so that roots do not depend
// on the order of the unions).
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace trueblade {

class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  // The smallest member of the set of `i`.
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    i = root(i);
    j = root(j);
    if (i > j) std::swap(i, j);
    parent_[j] = i;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace trueblade
