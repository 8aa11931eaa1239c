// The data of the exact closest-point search: an eight-wide bounding-volume tree over leaves of eight facets.
// Internal to geometry; ClosestPointTree is the way in.
//
// Everything in float only excludes: a box or a leaf facet gives a lower bound of the distance that accounts
// for every rounding error. What is not excluded is measured in double, by the same operations on every
// machine (facet_projection-inl.h), and of equal distances the lower facet number wins. So the answer is a
// function of the facets and the query alone: not of the tree's shape, the order of the search or the
// instruction set.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/facet_model.h"

namespace trueblade {

inline constexpr std::uint32_t kTreeWidth = 8;        // children of a node, facets of a leaf
inline constexpr std::uint32_t kLeafFlag = 1u << 31;  // in a child number: a leaf, not a node

// Boxes of the children, relative to the tree's centre, in mm, rounded outward. Unused places have lower >
// upper.
struct alignas(64) FacetTreeNode {
  float lower[3][kTreeWidth];
  float upper[3][kTreeWidth];
  std::uint32_t child[kTreeWidth];
  std::uint32_t children;
};

// Eight facets, structure of arrays. Each has an orthonormal frame (u along its longest edge AB, w along its
// normal) with the corner C opposite that edge at the origin, so that in the frame A = (a, -height), B = (b,
// -height), C = (0, 0). Unused places repeat the first facet.
struct alignas(64) FacetTreeLeaf {
  float u[3][kTreeWidth], v[3][kTreeWidth], w[3][kTreeWidth];
  float origin[3][kTreeWidth];  // C in the frame's directions, relative to `centre`
  float a[kTreeWidth], b[kTreeWidth], height[kTreeWidth];
  float inverse_ca2[kTreeWidth], inverse_cb2[kTreeWidth];  // 1 / |CA|^2, 1 / |CB|^2
  double centre_mm[3];
  // Bounds the distance from the centre to any corner, and carries the rounding of coordinates far from the
  // origin: the error of a float distance is at most kFloatError * (|query - centre| + radius).
  float radius_mm;
  std::uint32_t facets;
};

// A facet as it is measured: corners in the model's coordinates, (c, a) the longest edge.
struct FacetRecord {
  double corner_mm[3][3];
  std::uint32_t facet;
  std::uint32_t rotation;  // corner k here is corner (k + rotation) % 3 of the model's facet
};

struct FacetTree {
  Vec3 centre_mm = Vec3::Zero();
  std::unique_ptr<FacetTreeNode[]> nodes;  // nodes[0] is the root
  std::unique_ptr<FacetTreeLeaf[]> leaves;
  std::unique_ptr<FacetRecord[]> records;     // by place: leaf * kTreeWidth + lane
  std::vector<std::uint32_t> place_of_facet;  // kNoFacet for facets outside the selection
};

// Built over the listed facets, by any number of threads. Throws InputError when none is listed, a number is
// out of range or listed twice, or a coordinate is beyond 1e15 mm, where squares would leave the range of
// float.
FacetTree build_facet_tree(const FacetModel& model, std::span<const std::uint32_t> facets);

}  // namespace trueblade
