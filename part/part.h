// The nominal part: its facet model and the CAD surfaces behind it, in mm in the part coordinate system
// (PCS).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/facet_model.h"
#include "part/exact_surfaces.h"
#include "part/faceting_options.h"
#include "part/length_unit.h"
#include "part/part_surface.h"

namespace trueblade {

class SurfacesAround;

struct Part {
  std::string name;
  FacetModel model;
  FacetModelReport report;
  std::vector<PartSurface> surfaces;

  // Present when the part came from STEP or IGES: the surfaces themselves, for every facet the surface
  // parameters (u, v) of its three corners, from which a projection onto the exact surface starts, and what
  // other surfaces a projection from there may have to try.
  std::shared_ptr<const ExactSurfaces> exact;
  std::vector<std::array<Vec2, 3>> facet_parameters;
  std::shared_ptr<const SurfacesAround> surfaces_around;
  double chord_tolerance_mm = 0.0;  // that the facets keep; 0 when there are no exact surfaces
};

struct PartOptions {
  // Required for STL, PLY and OBJ (a PLY may state it by a comment "unit mm"), refused for STEP and IGES,
  // which carry their own.
  std::optional<LengthUnit> unit;
  FacetingOptions faceting;
};

// Reads STEP (.step .stp), IGES (.igs .iges), STL (.stl, both forms), PLY (.ply) or OBJ (.obj); the ending
// decides. Throws InputError for a file that is missing, empty, truncated, of another format, holds NaN or
// infinite coordinates, no surface or no facet, or a unit that is missing.
Part read_part(const std::filesystem::path& file, const PartOptions& options);

}  // namespace trueblade
