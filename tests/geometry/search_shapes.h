// Facet models on which searches go wrong if they can, and queries that try to make them.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "geometry/facet_model.h"
#include "geometry/random.h"
#include "tests/geometry/shapes.h"

namespace trueblade::shapes {

// Two sheets of unit squares, `thickness_mm` apart, not connected: the nearer one must win.
inline FacetSoup plate_pair(std::uint32_t columns, std::uint32_t rows, double thickness_mm) {
  FacetSoup soup = sheet(columns, rows), lower = sheet(columns, rows);
  for (Vec3& node : lower.nodes_mm) node.z() -= thickness_mm;
  for (auto& facet : lower.facets) std::swap(facet[1], facet[2]);
  append(soup, lower);
  return soup;
}

// Two sheets that meet in the y axis, x > 0, `angle_rad` apart.
inline FacetSoup wedge(std::uint32_t columns, std::uint32_t rows, double angle_rad) {
  FacetSoup soup = sheet(columns, rows), lower = sheet(columns, rows);
  for (Vec3& node : lower.nodes_mm)
    node = Vec3(node.x() * std::cos(angle_rad), node.y(), -node.x() * std::sin(angle_rad));
  for (auto& facet : lower.facets) std::swap(facet[1], facet[2]);
  append(soup, lower);
  return soup;
}

// Open cylinder about z, its nodes on two circles.
inline FacetSoup cylinder(double radius_mm, double height_mm, std::uint32_t around) {
  FacetSoup soup;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double u = 2.0 * std::numbers::pi * i / around;
    for (const double z : {-0.5 * height_mm, 0.5 * height_mm})
      soup.nodes_mm.push_back(Vec3(radius_mm * std::cos(u), radius_mm * std::sin(u), z));
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t here = 2 * i, next = 2 * ((i + 1) % around);
    soup.facets.push_back({here, next, next + 1});
    soup.facets.push_back({here, next + 1, here + 1});
  }
  return soup;
}

inline FacetSoup torus(double ring_mm, double tube_mm, std::uint32_t around, std::uint32_t across) {
  FacetSoup soup;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around, v = 2.0 * std::numbers::pi * j / across;
      const double r = ring_mm + tube_mm * std::cos(v);
      soup.nodes_mm.push_back(Vec3(r * std::cos(u), r * std::sin(u), tube_mm * std::sin(v)));
    }
  const auto node = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      soup.facets.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
      soup.facets.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return soup;
}

// A fan of long thin facets, 100 mm by 0.1 um each, as CAD exports have along a cylinder.
inline FacetSoup slivers(std::uint32_t count) {
  FacetSoup soup;
  for (std::uint32_t i = 0; i <= count; ++i) {
    const double y = 1e-4 * i;
    soup.nodes_mm.push_back(Vec3(0.0, y, 0.1 * y * y));
    soup.nodes_mm.push_back(Vec3(100.0, y, 0.1 * y * y));
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    soup.facets.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    soup.facets.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  return soup;
}

// Facets without any order, of very different sizes, through one another.
inline FacetSoup random_facets(std::uint32_t count, std::uint64_t seed) {
  FacetSoup soup;
  Rng rng(seed, 0, "random facets");
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 at = 30.0 * rng.normal_vector();
    const double size = std::exp(2.0 * rng.normal());
    for (int k = 0; k < 3; ++k) soup.nodes_mm.push_back(at + size * rng.normal_vector());
    soup.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return soup;
}

struct NamedModel {
  std::string name;
  FacetModel model;
};

inline std::vector<NamedModel> search_models() {
  const auto model = [](const FacetSoup& soup) { return build_facet_model(soup, 0.0).model; };
  FacetSoup shells = sphere(5.0, 2, {-20.0, 0.0, 0.0});
  append(shells, sphere(4.9, 2, {-20.0, 0.0, 0.0}));
  append(shells, cube(30.0, {10.0, 5.0, 3.0}));
  return {{"one facet", model({{{0, 0, 0}, {3, 0, 0}, {1, 2, 0}}, {{0, 1, 2}}, {}})},
          {"cube", model(cube(10.0))},
          {"sphere", model(sphere(40.0, 4))},
          {"plate pair", model(plate_pair(25, 25, 0.3))},
          {"wedge", model(wedge(25, 25, 0.05))},
          {"torus", model(torus(40.0, 10.0, 60, 24))},
          {"slivers", model(slivers(300))},
          {"shells", model(shells)},
          {"random facets", model(random_facets(1000, 7))}};
}

// Queries on, near and far from the model: on nodes, edges and facets, off them by 1e-9 to 100 mm, and
// anywhere.
inline std::vector<Vec3> search_queries(const FacetModel& model, std::size_t count, std::uint64_t seed) {
  std::vector<Vec3> queries;
  Rng rng(seed, 0, "search queries");
  const Vec3 middle = 0.5 * (model.lower_corner_mm() + model.upper_corner_mm());
  for (std::size_t i = 0; i < count; ++i) {
    const auto facet = static_cast<std::uint32_t>(rng.uniform() * static_cast<double>(model.facet_count()));
    const auto [a, b, c] = model.corners_mm(facet);
    const double u = rng.uniform(), v = rng.uniform() * (1.0 - u);
    const Vec3 direction = rng.normal_vector();
    const Vec3 inside = a + u * (b - a) + v * (c - a);
    const double off_mm = std::pow(10.0, -9.0 + 11.0 * rng.uniform());
    switch (i % 8) {
      case 0:
        queries.push_back(a);
        break;
      case 1:
        queries.push_back(a + u * (b - a));
        break;
      case 2:
        queries.push_back(inside);
        break;
      case 3:
        queries.push_back(a + off_mm * direction);
        break;
      case 4:
        queries.push_back(a + u * (b - a) + off_mm * direction);
        break;
      case 5:
        queries.push_back(inside + off_mm * direction);
        break;
      case 6:
        queries.push_back(middle + 50.0 * direction);
        break;
      default:
        queries.push_back(i % 16 == 7 ? middle : Vec3(middle + 1e6 * direction));
        break;
    }
  }
  return queries;
}

}  // namespace trueblade::shapes
