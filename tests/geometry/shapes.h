// Facet soups with known answers, for the tests of this folder.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "geometry/facet_model.h"

namespace trueblade::shapes {

// The cube [0, edge]^3: 8 nodes, 12 facets.
inline FacetSoup cube(double edge_mm, const Vec3& lower_corner_mm = Vec3::Zero()) {
  FacetSoup soup;
  for (int i = 0; i < 8; ++i)
    soup.nodes_mm.push_back(lower_corner_mm + edge_mm * Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1));
  soup.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return soup;
}

// Adds one soup to another; nodes are not shared.
inline void append(FacetSoup& soup, const FacetSoup& other) {
  const auto offset = static_cast<std::uint32_t>(soup.nodes_mm.size());
  soup.nodes_mm.insert(soup.nodes_mm.end(), other.nodes_mm.begin(), other.nodes_mm.end());
  for (const auto& [a, b, c] : other.facets) soup.facets.push_back({a + offset, b + offset, c + offset});
}

// The same facets with three nodes of their own each, as an STL file has them.
inline FacetSoup unconnected(const FacetSoup& soup) {
  FacetSoup loose;
  for (const auto& nodes : soup.facets) {
    const auto first = static_cast<std::uint32_t>(loose.nodes_mm.size());
    for (const std::uint32_t node : nodes) loose.nodes_mm.push_back(soup.nodes_mm[node]);
    loose.facets.push_back({first, first + 1, first + 2});
  }
  return loose;
}

// A flat sheet of columns x rows unit squares in the plane z = 0, two facets each, normal +z.
inline FacetSoup sheet(std::uint32_t columns, std::uint32_t rows) {
  FacetSoup soup;
  for (std::uint32_t y = 0; y <= rows; ++y)
    for (std::uint32_t x = 0; x <= columns; ++x) soup.nodes_mm.push_back(Vec3(x, y, 0.0));
  const auto node = [&](std::uint32_t x, std::uint32_t y) { return y * (columns + 1) + x; };
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x) {
      soup.facets.push_back({node(x, y), node(x + 1, y), node(x + 1, y + 1)});
      soup.facets.push_back({node(x, y), node(x + 1, y + 1), node(x, y + 1)});
    }
  return soup;
}

// An icosahedron subdivided `levels` times, its nodes on the sphere: 20 * 4^levels facets, closed.
inline FacetSoup sphere(double radius_mm, int levels, const Vec3& centre_mm = Vec3::Zero()) {
  const double t = std::numbers::phi;
  FacetSoup soup;
  soup.nodes_mm = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  soup.facets = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle_of;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middle_of.try_emplace(std::minmax(a, b), soup.nodes_mm.size());
      if (is_new)
        soup.nodes_mm.push_back(0.5 * (soup.nodes_mm[a].normalized() + soup.nodes_mm[b].normalized()));
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : soup.facets) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    soup.facets = std::move(finer);
  }
  for (Vec3& node : soup.nodes_mm) node = centre_mm + radius_mm * node.normalized();
  return soup;
}

}  // namespace trueblade::shapes
