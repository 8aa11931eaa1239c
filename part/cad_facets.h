// A STEP or IGES part as facets and exact surfaces, in plain data: OpenCASCADE stays on the other side of
// this header (its macros and OpenMesh's headers do not bear each other in one source file).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/vector.h"
#include "part/exact_surfaces.h"
#include "part/faceting_options.h"
#include "part/part_surface.h"

namespace trueblade {

struct CadFacets {
  std::vector<Vec3> nodes_mm;
  std::vector<std::array<std::uint32_t, 3>> facets;  // counter-clockwise seen from outside
  std::vector<std::uint32_t> surface_of_facet;
  std::vector<std::array<Vec2, 3>> corner_parameters;  // of each facet on its surface
  std::vector<PartSurface> surfaces;                   // surface i is face i of the shape
  std::shared_ptr<const ExactSurfaces> exact;
  double chord_tolerance_mm = 0.0;  // that the facets keep
};

enum class CadFormat { step, iges };

// Reads and facets a CAD file. Throws InputError as read_part does.
CadFacets read_cad_facets(const std::filesystem::path& file, CadFormat format,
                          const FacetingOptions& faceting);

}  // namespace trueblade
