#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "geometry/closest_point.h"
#include "geometry/error.h"
#include "geometry/facet_tree.h"
#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr std::uint32_t kParallelLeaves = 512;  // subtrees below this many leaves are built by one thread

// Box of a facet relative to the tree's centre.
struct FacetBox {
  Eigen::Array3f lower, upper;
  std::uint32_t facet;
  Eigen::Array3f middle() const { return lower + upper; }  // twice the middle: only compared
};

struct Box {
  Eigen::Array3f lower = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Array3f upper = -lower;
  void include(const Eigen::Array3f& low, const Eigen::Array3f& high) {
    lower = lower.min(low);
    upper = upper.max(high);
  }
};

// Leaves on the left when `leaves` leaves are split in two.
std::uint32_t left_leaves(std::uint32_t leaves) {
  return (leaves + 1) / 2;
}

// The leaf counts of the children of a node over `leaves` leaves: three halvings.
std::vector<std::uint32_t> child_leaf_counts(std::uint32_t leaves) {
  std::vector<std::uint32_t> counts{leaves};
  for (int level = 0; level < 3; ++level) {
    std::vector<std::uint32_t> halves;
    for (const std::uint32_t count : counts) {
      halves.push_back(left_leaves(count));
      if (count > 1) halves.push_back(count - left_leaves(count));
    }
    counts = std::move(halves);
  }
  return counts;
}

// Nodes of the subtree over `leaves` leaves. A function of the count alone, so that every subtree knows its
// place and threads need not agree on anything.
std::uint32_t node_count(std::uint32_t leaves) {
  if (leaves <= kTreeWidth) return 1;
  std::uint32_t nodes = 1;
  for (const std::uint32_t count : child_leaf_counts(leaves)) nodes += count > 1 ? node_count(count) : 0;
  return nodes;
}

class Builder {
 public:
  Builder(FacetTree& tree, std::vector<FacetBox>& boxes, const FacetModel& model)
      : tree_(tree), boxes_(boxes), model_(model) {}

  // Builds the node over the leaves [first, first + leaves) into nodes[place] and returns its box.
  Box build_node(std::uint32_t place, std::uint32_t first, std::uint32_t leaves) {
    const std::vector<std::uint32_t> counts = child_leaf_counts(leaves);
    halve(first, leaves, 3);
    FacetTreeNode node{};
    for (int axis = 0; axis < 3; ++axis) {  // unused places are out of everybody's reach
      std::fill_n(node.lower[axis], kTreeWidth, std::numeric_limits<float>::infinity());
      std::fill_n(node.upper[axis], kTreeWidth, -std::numeric_limits<float>::infinity());
    }
    node.children = static_cast<std::uint32_t>(counts.size());
    std::array<Box, kTreeWidth> boxes;
    std::array<std::uint32_t, kTreeWidth> first_leaf{}, child_place{};
    std::uint32_t next_leaf = first, next_place = place + 1;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      first_leaf[k] = next_leaf;
      child_place[k] = next_place;
      next_leaf += counts[k];
      if (counts[k] > 1) next_place += node_count(counts[k]);
      node.child[k] = counts[k] > 1 ? child_place[k] : first_leaf[k] | kLeafFlag;
    }
    const auto build_child = [&](std::size_t k) {
      boxes[k] =
          counts[k] > 1 ? build_node(child_place[k], first_leaf[k], counts[k]) : build_leaf(first_leaf[k]);
    };
    if (leaves >= kParallelLeaves)
      parallel_for_blocks(counts.size(), 1, [&](std::size_t k, std::size_t) { build_child(k); });
    else
      for (std::size_t k = 0; k < counts.size(); ++k) build_child(k);
    Box all;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      all.include(boxes[k].lower, boxes[k].upper);
      for (int axis = 0; axis < 3; ++axis) {
        node.lower[axis][k] = boxes[k].lower[axis];
        node.upper[axis][k] = boxes[k].upper[axis];
      }
    }
    tree_.nodes[place] = node;
    return all;
  }

 private:
  std::uint32_t begin_of(std::uint32_t leaf) const {
    return std::min(leaf * kTreeWidth, static_cast<std::uint32_t>(boxes_.size()));
  }

  // Orders the boxes so that `levels` successive halvings of the leaf range are spatial.
  void halve(std::uint32_t first, std::uint32_t leaves, int levels) {
    if (levels == 0 || leaves < 2) return;
    const auto begin = boxes_.begin() + begin_of(first), end = boxes_.begin() + begin_of(first + leaves);
    Box middles;
    for (auto box = begin; box != end; ++box) middles.include(box->middle(), box->middle());
    Eigen::Index axis = 0;
    (middles.upper - middles.lower).maxCoeff(&axis);
    const std::uint32_t left = left_leaves(leaves);
    std::nth_element(begin, boxes_.begin() + begin_of(first + left), end,
                     [axis](const FacetBox& a, const FacetBox& b) {
                       const float ma = a.middle()[axis], mb = b.middle()[axis];
                       return ma != mb ? ma < mb : a.facet < b.facet;
                     });
    halve(first, left, levels - 1);
    halve(first + left, leaves - left, levels - 1);
  }

  Box build_leaf(std::uint32_t number) {
    const std::uint32_t begin = begin_of(number), end = begin_of(number + 1);
    std::sort(boxes_.begin() + begin, boxes_.begin() + end,
              [](const FacetBox& a, const FacetBox& b) { return a.facet < b.facet; });
    FacetTreeLeaf& leaf = tree_.leaves[number];
    leaf.facets = end - begin;
    Box box;
    for (std::uint32_t place = begin; place < end; ++place)
      box.include(boxes_[place].lower, boxes_[place].upper);
    const Vec3 centre = tree_.centre_mm + 0.5 * (box.lower + box.upper).cast<double>().matrix();
    double radius_squared = 0.0;
    for (std::uint32_t lane = 0; lane < kTreeWidth; ++lane) {
      const std::uint32_t facet = boxes_[lane < leaf.facets ? begin + lane : begin].facet;
      const std::array<Vec3, 3> corners = model_.corners_mm(facet);
      if (lane < leaf.facets) tree_.place_of_facet[facet] = number * kTreeWidth + lane;
      for (const Vec3& corner : corners)
        radius_squared = std::max(radius_squared, (corner - centre).squaredNorm());
      const int base = longest_edge(corners);
      FacetRecord& record = tree_.records[number * kTreeWidth + lane];
      record.facet = facet;
      record.rotation = static_cast<std::uint32_t>((base + 1) % 3);
      for (int k = 0; k < 3; ++k) Eigen::Map<Vec3>(record.corner_mm[k]) = corners[(k + base + 1) % 3];
      write_lane(leaf, lane, corners[base], corners[(base + 1) % 3], corners[(base + 2) % 3], centre);
    }
    Eigen::Map<Vec3>(leaf.centre_mm) = centre;
    // 1e-8 |centre|: coordinates of 1e4 mm are rounded to 1e-12 mm, which kFloatError times this covers 100
    // times.
    leaf.radius_mm = static_cast<float>(std::sqrt(radius_squared) * (1.0 + 1e-6) + 1e-8 * centre.norm());
    return box;
  }

  // The edge that the base of the facet's frame is: then the foot of the height lies on it, and a flat
  // triangle still has a frame.
  static int longest_edge(const std::array<Vec3, 3>& corners) {
    int base = 0;
    double longest = -1.0;
    for (int k = 0; k < 3; ++k) {
      const double length = (corners[(k + 1) % 3] - corners[k]).squaredNorm();
      if (length > longest) {
        longest = length;
        base = k;
      }
    }
    return base;
  }

  // Frame of the facet with the base (a, b) and the corner c opposite.
  static void write_lane(FacetTreeLeaf& leaf, std::uint32_t lane, const Vec3& a, const Vec3& b, const Vec3& c,
                         const Vec3& centre) {
    const double longest = (b - a).squaredNorm();
    const Vec3 u = longest > 0.0 ? Vec3((b - a) / std::sqrt(longest)) : Vec3::UnitX();
    Vec3 v = (c - a) - u * u.dot(c - a);
    v -= u * u.dot(v);  // once more: the first difference cancels in a thin triangle
    const double height = v.norm();
    v = height > 0.0 ? Vec3(v / height) : u.unitOrthogonal();
    v = (v - u * u.dot(v)).normalized();
    const Vec3 w = u.cross(v);
    for (int axis = 0; axis < 3; ++axis) {
      leaf.u[axis][lane] = static_cast<float>(u[axis]);
      leaf.v[axis][lane] = static_cast<float>(v[axis]);
      leaf.w[axis][lane] = static_cast<float>(w[axis]);
    }
    const Vec3 origin = c - centre;
    leaf.origin[0][lane] = static_cast<float>(u.dot(origin));
    leaf.origin[1][lane] = static_cast<float>(v.dot(origin));
    leaf.origin[2][lane] = static_cast<float>(w.dot(origin));
    leaf.a[lane] = static_cast<float>(u.dot(a - c));
    leaf.b[lane] = static_cast<float>(u.dot(b - c));
    leaf.height[lane] = static_cast<float>(height);
    const double ca2 = (a - c).squaredNorm(), cb2 = (b - c).squaredNorm();
    leaf.inverse_ca2[lane] = ca2 > 1e-30 ? static_cast<float>(1.0 / ca2) : 0.0F;
    leaf.inverse_cb2[lane] = cb2 > 1e-30 ? static_cast<float>(1.0 / cb2) : 0.0F;
  }

  FacetTree& tree_;
  std::vector<FacetBox>& boxes_;
  const FacetModel& model_;
};

}  // namespace

FacetTree build_facet_tree(const FacetModel& model, std::span<const std::uint32_t> facets) {
  if (facets.empty()) throw InputError("closest-point tree: no facet is selected");
  FacetTree tree;
  tree.place_of_facet.assign(model.facet_count(), kNoFacet);
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (const std::uint32_t facet : facets) {
    if (facet >= model.facet_count())
      throw InputError("closest-point tree: facet " + std::to_string(facet) + " is not one of the model's " +
                       std::to_string(model.facet_count()));
    if (tree.place_of_facet[facet] != kNoFacet)
      throw InputError("closest-point tree: facet " + std::to_string(facet) + " is selected twice");
    tree.place_of_facet[facet] = 0;
    for (const Vec3& corner : model.corners_mm(facet)) {
      lower = lower.cwiseMin(corner);
      upper = upper.cwiseMax(corner);
    }
  }
  const double extent = std::max(lower.cwiseAbs().maxCoeff(), upper.cwiseAbs().maxCoeff());
  if (!(extent <= 1e15)) throw InputError("closest-point tree: coordinates must be within 1e15 mm");
  tree.centre_mm = 0.5 * (lower + upper);

  // Rounding to float is at most half an ulp, 2^-24 of the largest coordinate relative to the centre; 2^-22
  // covers it and what a query loses in double when it is taken relative to the centre (2^-52 of the
  // coordinates).
  const float pad =
      static_cast<float>(std::ldexp((upper - tree.centre_mm).maxCoeff(), -22) + std::ldexp(extent, -48));
  std::vector<FacetBox> boxes(facets.size());
  parallel_for_blocks(facets.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [a, b, c] = model.corners_mm(facets[i]);
      const Vec3 low = a.cwiseMin(b).cwiseMin(c) - tree.centre_mm,
                 high = a.cwiseMax(b).cwiseMax(c) - tree.centre_mm;
      boxes[i] = {low.cast<float>().array() - pad, high.cast<float>().array() + pad, facets[i]};
    }
  });
  const auto leaves = static_cast<std::uint32_t>((facets.size() + kTreeWidth - 1) / kTreeWidth);
  tree.nodes.resize(node_count(leaves));
  tree.leaves.resize(leaves);
  tree.records.resize(std::size_t{leaves} * kTreeWidth);
  Builder(tree, boxes, model).build_node(0, 0, leaves);
  return tree;
}

}  // namespace trueblade
