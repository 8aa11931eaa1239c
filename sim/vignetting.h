// The cone of light between the point and the sensor's aperture: what of it the part cuts off on its way.
#pragma once

#include "sim/virtual_part.h"

namespace trueblade {

// Share of the light on the aperture, a disc of this radius about the probe origin and across the beam, that
// the part leaves free: of eight rays to its rim. `beam` in the PCS, `hit` its first hit. Precondition:
// aperture_radius_mm > 0.
double free_light(const VirtualPart& part, const Ray& beam, const PartHit& hit, double aperture_radius_mm);

}  // namespace trueblade
