// The CAD surfaces that meet at a facet and around its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "part/part.h"

namespace trueblade {

// Calls visit(facet) with one facet of each surface, the given facet first, until it returns false. Inside a
// surface all the facets around are on it, and there is one call.
template <class Visit>
void visit_surfaces_around(const Part& part, std::uint32_t facet, const Visit& visit) {
  std::array<std::uint32_t, 16> visited;  // more surfaces than this do not meet at one facet's corners
  auto end = visited.begin();
  const auto goes_on = [&](std::uint32_t of_surface) {
    const std::uint32_t surface = part.model.surface_of(of_surface);
    if (end == visited.end() || std::find(visited.begin(), end, surface) != end) return true;
    *end++ = surface;
    return visit(of_surface);
  };
  if (!goes_on(facet)) return;
  const FacetMesh& mesh = part.model.mesh();
  for (const std::uint32_t node : part.model.facet_nodes(facet))
    for (const auto face : mesh.vf_range(FacetMesh::VertexHandle(static_cast<int>(node))))
      if (!goes_on(static_cast<std::uint32_t>(face.idx()))) return;
}

}  // namespace trueblade
