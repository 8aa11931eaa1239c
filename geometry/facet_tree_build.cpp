#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/error.h"
#include "geometry/facet_tree.h"
#include "geometry/facet_tree_leaf.h"
#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr std::uint32_t kParallelLeaves = 128;  // a subtree below this many leaves is built by one thread

// What the facets are sorted by while the tree takes shape.
struct alignas(16) FacetMiddle {
  float middle[3];  // of its box, relative to the tree's centre
  std::uint32_t facet;
};

// Total order along an axis: of equal middles the lower facet number comes first.
template <int kAxis>
bool before(const FacetMiddle& a, const FacetMiddle& b) {
  return a.middle[kAxis] != b.middle[kAxis] ? a.middle[kAxis] < b.middle[kAxis] : a.facet < b.facet;
}

// Moves the `left` first facets along the axis to the front of `facets`. A comparison that the processor
// cannot foresee costs ten times a comparison: so the facets are counted into slices along the axis first,
// moved to the front, the slice of the cut or the back without a branch, and only the slice of the cut is
// compared.
template <int kAxis, std::size_t kSlices>
void divide_by_slices(std::span<FacetMiddle> facets, std::size_t left, float lower, float upper,
                      std::span<FacetMiddle> scratch) {
  const float slices_per_mm = (static_cast<float>(kSlices) - 0.5F) / (upper - lower);
  const auto slice_of = [&](const FacetMiddle& facet) {  // never falls along the axis
    return std::min(static_cast<std::int32_t>((facet.middle[kAxis] - lower) * slices_per_mm),
                    static_cast<std::int32_t>(kSlices) - 1);
  };
  std::array<std::uint32_t, kSlices> count{};
  for (const FacetMiddle& facet : facets) ++count[static_cast<std::size_t>(slice_of(facet))];
  std::int32_t cut = 0;
  std::size_t below = 0;
  while (below + count[static_cast<std::size_t>(cut)] <= left)
    below += count[static_cast<std::size_t>(cut++)];
  const std::size_t within = count[static_cast<std::size_t>(cut)];
  std::array<std::size_t, 3> next{0, below, below + within};
  for (const FacetMiddle& facet : facets) {
    const std::int32_t slice = slice_of(facet);
    scratch[next[static_cast<std::size_t>((slice >= cut) + (slice > cut))]++] = facet;
  }
  const auto first = scratch.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(first, scratch.begin() + static_cast<std::ptrdiff_t>(left),
                   first + static_cast<std::ptrdiff_t>(within), before<kAxis>);
  std::copy(scratch.begin(), scratch.begin() + static_cast<std::ptrdiff_t>(facets.size()), facets.begin());
}

template <int kAxis>
void divide(std::span<FacetMiddle> facets, std::size_t left, float lower, float upper,
            std::span<FacetMiddle> scratch) {
  constexpr std::size_t kMany = 1024;  // so many are worth more slices, which take time to clear and to sum
  if (!(upper > lower))                // then the facet numbers decide
    std::nth_element(facets.begin(), facets.begin() + static_cast<std::ptrdiff_t>(left), facets.end(),
                     before<kAxis>);
  else if (facets.size() < kMany)
    divide_by_slices<kAxis, 64>(facets, left, lower, upper, scratch);
  else
    divide_by_slices<kAxis, 256>(facets, left, lower, upper, scratch);
}

struct Box {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = -lower;
  void include(const Vec3& point) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  void include(const Box& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
};

// How the leaves of a node are dealt out to its children: three halvings.
struct ChildLeaves {
  std::array<std::uint32_t, kTreeWidth> count{};
  std::uint32_t children = 0;

  explicit ChildLeaves(std::uint32_t leaves) { deal(leaves, 3); }
  static std::uint32_t left_half(std::uint32_t leaves) { return (leaves + 1) / 2; }

 private:
  void deal(std::uint32_t leaves, int halvings) {
    if (halvings == 0 || leaves == 1) {
      count[children++] = leaves;
    } else {
      deal(left_half(leaves), halvings - 1);
      deal(leaves - left_half(leaves), halvings - 1);
    }
  }
};

// Nodes of the subtree over `leaves` leaves. A function of the count alone, so that every subtree knows its
// place and threads need not agree on anything. Halving gives children of at most two different sizes.
std::uint32_t node_count(std::uint32_t leaves) {
  if (leaves == 1) return 0;
  if (leaves <= kTreeWidth) return 1;
  const ChildLeaves deal(leaves);
  const auto sizes = std::minmax_element(deal.count.begin(), deal.count.begin() + deal.children);
  const auto small = static_cast<std::uint32_t>(
      std::count(deal.count.begin(), deal.count.begin() + deal.children, *sizes.first));
  return 1 + small * node_count(*sizes.first) + (deal.children - small) * node_count(*sizes.second);
}

// The edge that is the base of the facet's frame: then the foot of the height lies on it, and a flat triangle
// still has a frame.
std::uint32_t longest_edge(const std::array<Vec3, 3>& corners) {
  const double first = (corners[1] - corners[0]).squaredNorm(),
               second = (corners[2] - corners[1]).squaredNorm(),
               third = (corners[0] - corners[2]).squaredNorm();
  return third > first && third > second ? 2U : second > first ? 1U : 0U;
}

class Builder {
 public:
  Builder(FacetTree& tree, std::vector<FacetMiddle>& middles, const FacetModel& model, double pad_mm)
      : tree_(tree), middles_(middles), scratch_(middles.size()), model_(model), pad_mm_(pad_mm) {}

  // Builds the node over the leaves [first, first + leaves) into nodes[place] and returns its box, relative
  // to the tree's centre.
  Box build_node(std::uint32_t place, std::uint32_t first, std::uint32_t leaves) {
    halve(first, leaves, 3);
    const ChildLeaves deal(leaves);
    FacetTreeNode& node = tree_.nodes[place];
    node.children = deal.children;
    std::array<std::uint32_t, kTreeWidth> first_leaf{};
    std::uint32_t next_leaf = first, next_place = place + 1;
    for (std::uint32_t k = 0; k < deal.children; ++k) {
      first_leaf[k] = next_leaf;
      next_leaf += deal.count[k];
      node.child[k] = deal.count[k] > 1 ? next_place : first_leaf[k] | kLeafFlag;
      next_place += node_count(deal.count[k]);
    }
    std::array<Box, kTreeWidth> boxes;
    const auto build_child = [&](std::size_t k, std::size_t) {
      boxes[k] = deal.count[k] > 1 ? build_node(node.child[k], first_leaf[k], deal.count[k])
                                   : build_leaf(first_leaf[k]);
    };
    if (leaves >= kParallelLeaves)
      parallel_for_blocks(deal.children, 1, build_child);
    else
      for (std::uint32_t k = 0; k < deal.children; ++k) build_child(k, k + 1);
    Box all;
    for (std::uint32_t k = 0; k < kTreeWidth; ++k) {
      all.include(boxes[k]);
      for (int axis = 0; axis < 3; ++axis) {
        node.lower[axis][k] = static_cast<float>(boxes[k].lower[axis] - pad_mm_);
        node.upper[axis][k] = static_cast<float>(boxes[k].upper[axis] + pad_mm_);
      }
      if (k >= deal.children) node.child[k] = 0;
    }
    return all;
  }

  Box build_leaf(std::uint32_t number) {
    const auto begin = middles_.begin() + begin_of(number), end = middles_.begin() + begin_of(number + 1);
    std::sort(begin, end, [](const FacetMiddle& a, const FacetMiddle& b) { return a.facet < b.facet; });
    FacetTreeLeaf& leaf = tree_.leaves[number];
    leaf.facets = static_cast<std::uint32_t>(end - begin);
    LeafCorners lanes;
    Box box;
    for (std::uint32_t lane = 0; lane < kTreeWidth; ++lane) {
      const std::uint32_t facet = begin[lane < leaf.facets ? lane : 0].facet;
      const std::array<Vec3, 3> corners = model_.corners_mm(facet);
      const std::uint32_t base = longest_edge(corners);
      const std::uint32_t place = number * kTreeWidth + lane;
      FacetRecord& record = tree_.records[place];
      record.facet = facet;
      record.rotation = (base + 1) % 3;
      const Vec3 &a = corners[base], &b = corners[(base + 1) % 3], &c = corners[(base + 2) % 3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        record.corner_mm[0][axis] = lanes.b[axis][lane] = b[k];
        record.corner_mm[1][axis] = lanes.c[axis][lane] = c[k];
        record.corner_mm[2][axis] = lanes.a[axis][lane] = a[k];
      }
      for (const Vec3& corner : corners) box.include(corner - tree_.centre_mm);
      if (lane < leaf.facets) tree_.place_of_facet[facet] = place;
    }
    Eigen::Map<Vec3>(leaf.centre_mm) = tree_.centre_mm + 0.5 * (box.lower + box.upper);
    write_leaf(lanes, leaf);
    return box;
  }

 private:
  std::uint32_t begin_of(std::uint32_t leaf) const {
    return std::min(leaf * kTreeWidth, static_cast<std::uint32_t>(middles_.size()));
  }

  // Sorts the facets so that `halvings` successive halvings of the leaf range cut space, each across the
  // longest side of what it halves. All leaves but the last stay full.
  void halve(std::uint32_t first, std::uint32_t leaves, int halvings) {
    if (halvings == 0 || leaves < 2) return;
    const std::size_t begin = begin_of(first), size = begin_of(first + leaves) - begin;
    const std::span<FacetMiddle> facets(middles_.data() + begin, size),
        scratch(scratch_.data() + begin, size);
    std::array<float, 3> lower{facets[0].middle[0], facets[0].middle[1], facets[0].middle[2]}, upper = lower;
    for (const FacetMiddle& facet : facets)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], facet.middle[axis]);
        upper[axis] = std::max(upper[axis], facet.middle[axis]);
      }
    std::size_t axis = 0;
    for (std::size_t other = 1; other < 3; ++other)
      if (upper[other] - lower[other] > upper[axis] - lower[axis]) axis = other;
    const std::uint32_t left = ChildLeaves::left_half(leaves);
    constexpr std::array kDivide{divide<0>, divide<1>, divide<2>};
    kDivide[axis](facets, begin_of(first + left) - begin, lower[axis], upper[axis], scratch);
    const auto halve_half = [&](std::size_t half, std::size_t) {
      if (half == 0)
        halve(first, left, halvings - 1);
      else
        halve(first + left, leaves - left, halvings - 1);
    };
    if (leaves >= kParallelLeaves) {
      parallel_for_blocks(2, 1, halve_half);
    } else {
      halve_half(0, 1);
      halve_half(1, 2);
    }
  }

  FacetTree& tree_;
  std::vector<FacetMiddle>& middles_;
  std::vector<FacetMiddle> scratch_;  // every range of middles_ has the same range of it to itself
  const FacetModel& model_;
  double pad_mm_;  // boxes are larger by this
};

void check_selection(const FacetModel& model, std::span<const std::uint32_t> facets) {
  if (facets.empty()) throw InputError("closest-point tree: no facet is selected");
  std::vector<bool> selected(model.facet_count(), false);
  for (const std::uint32_t facet : facets) {
    if (facet >= model.facet_count())
      throw InputError("closest-point tree: facet " + std::to_string(facet) + " is not one of the model's " +
                       std::to_string(model.facet_count()));
    if (selected[facet])
      throw InputError("closest-point tree: facet " + std::to_string(facet) + " is selected twice");
    selected[facet] = true;
  }
}

}  // namespace

FacetTree build_facet_tree(const FacetModel& model, std::span<const std::uint32_t> facets) {
  check_selection(model, facets);
  constexpr std::size_t kBlock = 4096;
  std::vector<Box> boxes((facets.size() + kBlock - 1) / kBlock);
  parallel_for_blocks(facets.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const Vec3& corner : model.corners_mm(facets[i])) boxes[begin / kBlock].include(corner);
  });
  Box all;
  for (const Box& box : boxes) all.include(box);
  const double largest = std::max(all.lower.cwiseAbs().maxCoeff(), all.upper.cwiseAbs().maxCoeff());
  if (!(largest <= 1e15)) throw InputError("closest-point tree: coordinates must be within 1e15 mm");

  FacetTree tree;
  tree.centre_mm = 0.5 * (all.lower + all.upper);
  std::vector<FacetMiddle> middles(facets.size());
  parallel_for_blocks(facets.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Box box;
      for (const Vec3& corner : model.corners_mm(facets[i])) box.include(corner - tree.centre_mm);
      const Vec3 middle = 0.5 * (box.lower + box.upper);
      for (int axis = 0; axis < 3; ++axis) middles[i].middle[axis] = static_cast<float>(middle[axis]);
      middles[i].facet = facets[i];
    }
  });

  // Rounding to float is at most half an ulp, 2^-24 of the largest coordinate relative to the centre; 2^-22
  // covers it and what a query loses in double when it is taken relative to the centre (2^-52 of the
  // coordinates).
  const double pad_mm = std::ldexp((all.upper - tree.centre_mm).maxCoeff(), -22) + std::ldexp(largest, -48);
  const auto leaves = static_cast<std::uint32_t>((facets.size() + kTreeWidth - 1) / kTreeWidth);
  tree.nodes = std::make_unique_for_overwrite<FacetTreeNode[]>(std::max(node_count(leaves), 1U));
  tree.leaves = std::make_unique_for_overwrite<FacetTreeLeaf[]>(leaves);
  tree.records = std::make_unique_for_overwrite<FacetRecord[]>(std::size_t{leaves} * kTreeWidth);
  tree.place_of_facet.assign(model.facet_count(), kNoFacet);
  Builder(tree, middles, model, pad_mm).build_node(0, 0, leaves);
  return tree;
}

}  // namespace trueblade
