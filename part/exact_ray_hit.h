// From the hit of a ray on the facets to its hit on the CAD surfaces.
#pragma once

#include <optional>

#include "geometry/ray_caster.h"
#include "part/part.h"

namespace trueblade {

struct ExactRayHit {
  SurfacePoint hit;
  double range_mm;
  std::uint32_t surface;  // may be a neighbour of the facet's surface
};

// Intersects the ray with the surface of the facet that it meets, `facet` at `facet_range_mm`, and with those
// of the facet's neighbours: near an edge of the part the facets of one surface stand where another surface
// is. A hit counts when it faces the ray from the same side as the facet and lies within the chord tolerance
// of the facet's plane: what differs more is on another part of a surface or on its continuation beyond an
// edge. The first such hit inside a face wins;
// if there is none, the one within the trimming margin that is nearest to the facet's.
//
// nullopt when the ray meets none of these surfaces: it passes by the part where a facet stands out of it (a
// hole's facets do), or the part has no exact surfaces.
std::optional<ExactRayHit> refine_to_exact(const Part& part, const Ray& ray, std::uint32_t facet,
                                           double facet_range_mm);

}  // namespace trueblade
