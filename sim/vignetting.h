// The cone of light between the point and the sensor's aperture: what of it the part cuts off on its way.
#pragma once

#include <optional>
#include <span>

#include "sim/virtual_part.h"

namespace trueblade {

// Of each point the share of the light on the aperture, a disc of this radius about the probe origin and
// across the beam, that the part leaves free: of eight ways to its rim. `beams` in the PCS, `hits` their
// first hits; 1 where there is none. Preconditions: aperture_radius_mm > 0, hits and light as many as beams.
void free_light(const VirtualPart& part, std::span<const Ray> beams,
                std::span<const std::optional<PartHit>> hits, double aperture_radius_mm,
                std::span<double> light);

}  // namespace trueblade
