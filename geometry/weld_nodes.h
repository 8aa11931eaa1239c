// Welding: which nodes of a facet soup are one and the same.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// For each node the number of the node that replaces it (itself when it keeps its place). In order of
// numbers, a node goes to the nearest node that kept its place and lies within `tolerance_mm`; so no node
// moves farther than the tolerance, and chains of close nodes do not collapse. 0 welds equal nodes only. A
// positive tolerance below 2^-44 of the bounding box is raised to that: less is the rounding of the
// coordinates. Linear cost. Precondition: finite coordinates, tolerance_mm >= 0.
std::vector<std::uint32_t> weld_nodes(std::span<const Vec3> nodes_mm, double tolerance_mm);

}  // namespace trueblade
