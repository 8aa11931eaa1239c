// From a place in space to the surface parameters of a facet there.
#pragma once

#include <cstdint>

#include "part/part.h"

namespace trueblade {

// The surface parameters at the point of the facet that is beside `point_mm`, near enough to start an
// iteration from: linear between the facet's corners. Precondition: the part has exact surfaces.
Vec2 parameters_beside(const Part& part, std::uint32_t facet, const Vec3& point_mm);

}  // namespace trueblade
