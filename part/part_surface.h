// What a part knows about each of its CAD surfaces.
#pragma once

#include <cstddef>
#include <string>

namespace trueblade {

// One CAD surface. Its id is its position in Part::surfaces and the number every facet, point and report
// uses.
struct PartSurface {
  std::string name;  // the name in the CAD file, or "surface_<id>"
  std::string kind;  // "plane", "cylinder", "b-spline", ... or "facets" for mesh files
  std::size_t facets = 0;
  double area_mm2 = 0.0;  // of its facets
};

}  // namespace trueblade
