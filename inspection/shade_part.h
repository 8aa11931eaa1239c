// A shaded picture of the part in light grey, ray-cast in parallel: the ground on which deviations are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/facet_model.h"
#include "geometry/ray_caster.h"
#include "inspection/viewpoint.h"

namespace trueblade {

struct ShadedPixels {
  int width_px = 0, height_px = 0;
  std::vector<std::uint32_t> rgb;  // 0x00RRGGBB, row by row; white behind the part
};

// Smooth shading inside a CAD surface (facets that meet at less than 40 degrees), thin lines where CAD
// surfaces meet, 16 samples where neighbouring pixels differ and one elsewhere. `caster` is over `model`.
ShadedPixels shade_part(const FacetModel& model, const RayCaster& caster, const Camera& camera);

}  // namespace trueblade
