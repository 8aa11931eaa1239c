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

namespace trueblade {

// One CAD surface. `id` is its position in Part::surfaces and the number every facet, point and report uses.
struct PartSurface {
  std::string name;  // the name in the CAD file, or "surface_<id>"
  std::string kind;  // "plane", "cylinder", "b-spline", ... or "facets" for mesh files
  std::size_t facets = 0;
  double area_mm2 = 0.0;  // of its facets
};

struct Part {
  std::string name;
  FacetModel model;
  FacetModelReport report;
  std::vector<PartSurface> surfaces;

  // Present when the part came from STEP or IGES: the surfaces themselves, and for every facet the surface
  // parameters (u, v) of its three corners, from which a projection onto the exact surface starts.
  std::shared_ptr<const ExactSurfaces> exact;
  std::vector<std::array<Vec2, 3>> facet_parameters;
};

// Length unit of files that carry none (STL, PLY, OBJ, point files).
enum class LengthUnit { millimetre, centimetre, metre, inch, micrometre };
double millimetres_per(LengthUnit unit);
// "mm", "cm", "m", "in", "um"; throws InputError naming the valid units.
LengthUnit parse_length_unit(const std::string& text);

// Faceting of exact surfaces. The chord tolerance bounds the distance between facet and surface. 0.01 mm is a
// third of the paper's implied value (0.002 mm RMS on facets) times ten points of safety on curved edges; see
// docs/formats.md.
struct FacetingOptions {
  double chord_tolerance_mm = 0.01;
  double angular_tolerance_rad =
      0.2;  // between normals of neighbouring facets, 11.5 degrees; bounds facets on small radii
  void validate() const;  // throws InputError naming the value and the constraint
};

struct PartOptions {
  std::optional<LengthUnit>
      unit;  // required for STL, PLY and OBJ, refused for STEP and IGES (they carry their own)
  FacetingOptions faceting;
};

// Reads STEP (.step .stp), IGES (.igs .iges), STL (.stl, both forms), PLY (.ply) or OBJ (.obj); the ending
// decides. Throws InputError for a file that is missing, empty, truncated, of another format, holds NaN or
// infinite coordinates, no surface or no facet, or a unit that is missing.
Part read_part(const std::filesystem::path& file, const PartOptions& options);

}  // namespace trueblade
