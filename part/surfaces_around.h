// The CAD surfaces that meet a facet at its corners, beside its own. Part frame, mm.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/facet_model.h"

namespace trueblade {

struct SurfaceAround {
  std::uint32_t facet;  // one of the surface's facets at the corners
  // A plane that all of them lie on or behind, as far from the middle of the facet in question as one through
  // its edges or corners can be.
  Vec3 normal;  // unit, to the side where none of them is
  double offset_mm;

  // No point of them is nearer than this; nothing is said where it is negative.
  double least_distance_mm(const Vec3& point_mm) const { return normal.dot(point_mm) - offset_mm; }
};

// Found once for a model, because few facets have any: inside a surface all the facets around are on it.
// Immutable; const calls may run from any number of threads.
class SurfacesAround {
 public:
  explicit SurfacesAround(const FacetModel& model);

  // Each surface once.
  std::span<const SurfaceAround> of(std::uint32_t facet) const {
    return std::span(surfaces_).subspan(begin_[facet], begin_[facet + 1] - begin_[facet]);
  }

 private:
  std::vector<SurfaceAround> surfaces_;  // around one facet after the other
  std::vector<std::size_t> begin_;       // of each facet in the list, and the list's end
};

}  // namespace trueblade
