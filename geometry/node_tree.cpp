#include "geometry/node_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace trueblade {
namespace {

constexpr std::uint32_t kBucket = 4;  // nodes of a leaf cell
// Halvings after which a box-decomposition step is content with what is left inside: a cluster that much
// smaller than its cell is split off however many nodes it keeps.
constexpr int kHalvings = 64;

struct Pending {
  double squared;
  std::uint32_t cell;
};
bool farther(const Pending& a, const Pending& b) {
  return a.squared > b.squared;
}

template <class Cell>
double squared_distance(const Cell& cell, const Vec3& query) {
  return (cell.lower - query).cwiseMax(query - cell.upper).cwiseMax(0.0).squaredNorm();
}

}  // namespace

NodeTree::NodeTree(const FacetModel& model, NodeTreeKind kind) : kind_(kind), node_(model.node_count()) {
  std::iota(node_.begin(), node_.end(), 0U);
  position_mm_.reserve(node_.size());
  for (const std::uint32_t node : node_) position_mm_.push_back(model.node_mm(node));
  const std::vector<Vec3> position_of_node = position_mm_;
  cells_.reserve(node_.size());
  build(0, static_cast<std::uint32_t>(node_.size()));
  for (std::size_t i = 0; i < node_.size(); ++i) position_mm_[i] = position_of_node[node_[i]];
}

// While the tree is built, position_mm_ is by node number.
std::uint32_t NodeTree::build(std::uint32_t first, std::uint32_t count) {
  const auto number = static_cast<std::uint32_t>(cells_.size());
  Cell cell{position_mm_[node_[first]], position_mm_[node_[first]], first, count, {0, 0}};
  for (std::uint32_t i = first; i < first + count; ++i) {
    cell.lower = cell.lower.cwiseMin(position_mm_[node_[i]]);
    cell.upper = cell.upper.cwiseMax(position_mm_[node_[i]]);
  }
  cells_.push_back(cell);
  if (count > kBucket && cell.lower != cell.upper) {  // nodes of one place stay together
    const std::uint32_t inside = kind_ == NodeTreeKind::kd ? split_at_midpoint(cell) : split_balanced(cell);
    const std::uint32_t inner = build(first, inside);
    const std::uint32_t outer = build(first + inside, count - inside);
    cells_[number].child[0] = inner;
    cells_[number].child[1] = outer;
  }
  return number;
}

// Cuts the longest side of the nodes' own box in the middle, which leaves nodes on both sides. Returns how
// many come first.
std::uint32_t NodeTree::split_at_midpoint(const Cell& cell) {
  Eigen::Index axis = 0;
  (cell.upper - cell.lower).maxCoeff(&axis);
  const double middle = cell.lower[axis] + 0.5 * (cell.upper[axis] - cell.lower[axis]);
  const auto begin = node_.begin() + cell.first;
  const auto cut = std::partition(begin, begin + cell.count,
                                  [&](std::uint32_t node) { return position_mm_[node][axis] <= middle; });
  return static_cast<std::uint32_t>(cut - begin);
}

// Centroid shrink: halves the box, each time keeping the half with more nodes, until at most two thirds are
// left inside. Then a third at least is inside and a third outside. Returns how many are inside.
std::uint32_t NodeTree::split_balanced(const Cell& cell) {
  Vec3 lower = cell.lower, upper = cell.upper;
  const auto begin = node_.begin() + cell.first;
  std::uint32_t inside = cell.count;
  for (int halving = 0; halving < kHalvings && 3 * std::uint64_t{inside} > 2 * std::uint64_t{cell.count};
       ++halving) {
    Eigen::Index axis = 0;
    (upper - lower).maxCoeff(&axis);
    const double middle = lower[axis] + 0.5 * (upper[axis] - lower[axis]);
    const auto below = [&](std::uint32_t node) { return position_mm_[node][axis] <= middle; };
    const auto count_below = static_cast<std::uint32_t>(std::count_if(begin, begin + inside, below));
    const bool keep_below = 2 * count_below >= inside;
    std::partition(begin, begin + inside, [&](std::uint32_t node) { return below(node) == keep_below; });
    inside = keep_below ? count_below : inside - count_below;
    (keep_below ? upper : lower)[axis] = middle;
  }
  return inside;
}

std::size_t NodeTree::depth() const {
  std::vector<std::size_t> depth(cells_.size(), 1);
  for (std::size_t i = 0; i < cells_.size(); ++i)  // parents come before their children
    for (const std::uint32_t child : cells_[i].child)
      if (child != 0) depth[child] = depth[i] + 1;
  return *std::max_element(depth.begin(), depth.end());
}

// Priority search: cells in the order of their distance, until that exceeds the last node's over (1 +
// epsilon).
void NodeTree::nearest(const Vec3& query_mm, double epsilon, std::span<std::uint32_t> nodes,
                       ClosestPointWork& work) const {
  const double stretch = (1.0 + epsilon) * (1.0 + epsilon);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::array<double, kMostNearest> squared;
  squared.fill(kInfinite);
  const std::size_t last = nodes.size() - 1;
  const auto offer = [&](double distance_squared, std::uint32_t node) {
    const auto nearer_than = [&](std::size_t k) {
      return distance_squared < squared[k] || (distance_squared == squared[k] && node < nodes[k]);
    };
    if (!nearer_than(last)) return;
    std::size_t k = last;
    for (; k > 0 && nearer_than(k - 1); --k) {
      squared[k] = squared[k - 1];
      nodes[k] = nodes[k - 1];
    }
    squared[k] = distance_squared;
    nodes[k] = node;
  };

  std::vector<Pending> waiting;
  waiting.reserve(64);
  waiting.push_back({0.0, 0});
  while (!waiting.empty()) {
    std::pop_heap(waiting.begin(), waiting.end(), farther);
    Pending next = waiting.back();
    waiting.pop_back();
    if (next.squared * stretch > squared[last]) break;
    for (;;) {  // down to the leaf cell on the query's side
      ++work.boxes_tested;
      const Cell& cell = cells_[next.cell];
      if (cell.child[0] == 0) break;
      Pending nearer{squared_distance(cells_[cell.child[0]], query_mm), cell.child[0]};
      Pending other{squared_distance(cells_[cell.child[1]], query_mm), cell.child[1]};
      if (other.squared < nearer.squared) std::swap(nearer, other);
      if (other.squared * stretch <= squared[last]) {
        waiting.push_back(other);
        std::push_heap(waiting.begin(), waiting.end(), farther);
      }
      next = nearer;
    }
    const Cell& leaf = cells_[next.cell];
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
      offer((position_mm_[i] - query_mm).squaredNorm(), node_[i]);
  }
}

}  // namespace trueblade
