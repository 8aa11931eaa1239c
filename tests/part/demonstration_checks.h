// What every demonstration part is checked for.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "geometry/error.h"
#include "part/part.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {

inline void expect_closed_manifold(const Part& part) {
  EXPECT_TRUE(part.report.closed);
  EXPECT_EQ(part.report.boundary_edges, 0u);
  EXPECT_EQ(part.report.non_manifold_edges, 0u);
  EXPECT_EQ(part.report.inconsistent_edges, 0u);
  EXPECT_EQ(part.report.shells, 1u);
  EXPECT_GT(part.model.volume_mm3(), 0.0);  // looks outward
}

inline void expect_named_surfaces_with_facets(const Part& part) {
  std::set<std::string> names;
  for (const PartSurface& surface : part.surfaces) {
    EXPECT_GT(surface.facets, 0u) << surface.name;
    EXPECT_TRUE(names.insert(surface.name).second) << surface.name << " twice";
  }
}

// The normals of the exact surfaces that meet in a node, for every node on a border between surfaces that
// `smooth` admits: the largest angle between two of them, in rad.
template <typename Predicate>
double largest_kink_rad(const Part& part, const Predicate& smooth) {
  std::map<std::uint32_t, std::map<std::uint32_t, Vec3>> normals;  // by node and surface
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    const std::uint32_t surface = part.model.surface_of(facet);
    if (!smooth(part.surfaces[surface].name)) continue;
    for (std::size_t k = 0; k < 3; ++k)
      normals[part.model.facet_nodes(facet)[k]][surface] =
          part.exact->evaluate(surface, part.facet_parameters[facet][k]).normal;
  }
  double largest = 0.0;
  std::size_t compared = 0;
  for (const auto& [node, by_surface] : normals)
    for (const auto& [surface, normal] : by_surface) {
      const Vec3& first = by_surface.begin()->second;
      largest = std::max(largest, (normal - first).norm());
      compared += surface != by_surface.begin()->first;
    }
  EXPECT_GT(compared, 100u);
  return largest;
}

// Expects an InputError that names the field.
template <typename Work>
void expect_refused(const std::string& field, const Work& work) {
  try {
    work();
    ADD_FAILURE() << field << " was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(field + " is "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("must be"), std::string::npos) << error.what();
  }
}

}  // namespace trueblade
