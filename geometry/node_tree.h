// Approximate nearest nodes of a facet model (paper, section 3.1, P3): nodes whose distance is at most (1 +
// epsilon) times that of the nearest (Eq. 1).
//
// Two trees: the balanced box-decomposition tree (Arya, Mount, Netanyahu, Silverman, Wu, "An optimal
// algorithm for approximate nearest neighbor searching", J. ACM 45, 1998), whose depth is logarithmic however
// the nodes cluster, and a k-d tree. Both are searched cell by cell in the order of their distance.
//
// Immutable after construction; queries may run from any number of threads (those of the authors' ANN
// library, which keeps its state in global variables, may not).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/closest_point_tree.h"

namespace trueblade {

enum class NodeTreeKind { box_decomposition, kd };

class NodeTree {
 public:
  static constexpr std::size_t kMostNearest = 8;

  NodeTree(const FacetModel& model, NodeTreeKind kind);

  std::size_t node_count() const { return node_.size(); }
  std::size_t depth() const;  // cells from the root to the deepest leaf

  // The nodes.size() nearest nodes, nearest first, each within (1 + epsilon) of the true one's distance:
  // every other node is at least as far as the last of them over (1 + epsilon). With epsilon 0, of equal
  // distances the lower node number wins. Adds the cells visited to work.boxes_tested. Preconditions: 1 to
  // kMostNearest nodes and not more than the model has, epsilon >= 0, the query finite.
  void nearest(const Vec3& query_mm, double epsilon, std::span<std::uint32_t> nodes,
               ClosestPointWork& work) const;

 private:
  // The nodes [first, first + count) of node_, inside their own bounding box; the children share them.
  struct Cell {
    Vec3 lower, upper;
    std::uint32_t first, count;
    std::uint32_t child[2];  // 0: a leaf
  };

  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  std::uint32_t split_at_midpoint(const Cell& cell);
  std::uint32_t split_balanced(const Cell& cell);

  NodeTreeKind kind_;
  std::vector<Cell> cells_;  // cells_[0] is the root
  std::vector<std::uint32_t> node_;
  std::vector<Vec3> position_mm_;  // of node_[i]
};

}  // namespace trueblade
