// Parts whose surfaces are known in closed form, for tests.
#pragma once

#include <cmath>
#include <numbers>

#include "geometry/facet_model.h"
#include "part/part.h"

namespace trueblade::testing {

inline Part part_of(const FacetSoup& soup, std::size_t surfaces = 1) {
  Part part;
  FacetModelBuild build = build_facet_model(soup, 0.0);
  part.model = std::move(build.model);
  part.report = build.report;
  part.surfaces.resize(surfaces);
  return part;
}

// A square plate normal to y at y = height_mm, facing +y, centred on the y axis; `cells` x `cells` squares.
// Facets with x < 0 are surface 0, the others surface 1.
inline Part plate(double height_mm, double side_mm, std::uint32_t cells = 4) {
  FacetSoup soup;
  const auto number = [&](std::uint32_t i, std::uint32_t k) { return i * (cells + 1) + k; };
  for (std::uint32_t i = 0; i <= cells; ++i)
    for (std::uint32_t k = 0; k <= cells; ++k)
      soup.nodes_mm.emplace_back(side_mm * (static_cast<double>(i) / cells - 0.5), height_mm,
                                 side_mm * (static_cast<double>(k) / cells - 0.5));
  for (std::uint32_t i = 0; i < cells; ++i)
    for (std::uint32_t k = 0; k < cells; ++k) {
      // z cross x is +y
      soup.facets.push_back({number(i, k), number(i, k + 1), number(i + 1, k + 1)});
      soup.facets.push_back({number(i, k), number(i + 1, k + 1), number(i + 1, k)});
      soup.surface_of_facet.insert(soup.surface_of_facet.end(), 2, i < cells / 2 ? 0 : 1);
    }
  return part_of(soup, 2);
}

// A sphere about the origin with nodes on it: facets lie inside by at most the chord sagitta.
inline Part sphere(double radius_mm, std::uint32_t rings = 60) {
  FacetSoup soup;
  const std::uint32_t around = 2 * rings;
  soup.nodes_mm.emplace_back(0.0, 0.0, -radius_mm);
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t k = 0; k < around; ++k) {
      const double latitude = std::numbers::pi * (static_cast<double>(i) / rings - 0.5);
      const double longitude = 2.0 * std::numbers::pi * k / around;
      soup.nodes_mm.emplace_back(radius_mm * std::cos(latitude) * std::cos(longitude),
                                 radius_mm * std::cos(latitude) * std::sin(longitude),
                                 radius_mm * std::sin(latitude));
    }
  soup.nodes_mm.emplace_back(0.0, 0.0, radius_mm);
  const std::uint32_t top = static_cast<std::uint32_t>(soup.nodes_mm.size() - 1);
  const auto number = [&](std::uint32_t i, std::uint32_t k) { return 1 + (i - 1) * around + k % around; };
  for (std::uint32_t k = 0; k < around; ++k) {
    soup.facets.push_back({0, number(1, k + 1), number(1, k)});
    soup.facets.push_back({top, number(rings - 1, k), number(rings - 1, k + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      soup.facets.push_back({number(i, k), number(i, k + 1), number(i + 1, k + 1)});
      soup.facets.push_back({number(i, k), number(i + 1, k + 1), number(i + 1, k)});
    }
  }
  return part_of(soup);
}

// A plate facing +y at y = 0 (surface 0), 40 x 40 mm, on which a wall of 1 mm stands at x = 10 to 11 (surface
// 1).
inline Part plate_with_wall(double wall_height_mm) {
  FacetSoup soup;
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint32_t surface) {
    const auto n = static_cast<std::uint32_t>(soup.nodes_mm.size());
    soup.nodes_mm.insert(soup.nodes_mm.end(), {a, b, c, d});
    soup.facets.push_back({n, n + 1, n + 2});
    soup.facets.push_back({n, n + 2, n + 3});
    soup.surface_of_facet.insert(soup.surface_of_facet.end(), 2, surface);
  };
  const double h = wall_height_mm;
  quad({-20, 0, -20}, {-20, 0, 20}, {20, 0, 20}, {20, 0, -20}, 0);
  quad({10, 0, -20}, {10, 0, 20}, {10, h, 20}, {10, h, -20}, 1);  // faces -x
  quad({11, 0, -20}, {11, h, -20}, {11, h, 20}, {11, 0, 20}, 1);  // faces +x
  quad({10, h, -20}, {10, h, 20}, {11, h, 20}, {11, h, -20}, 1);  // top
  return part_of(soup, 2);
}

}  // namespace trueblade::testing
