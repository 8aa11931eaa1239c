// Order along a space-filling curve: neighbours in the order are neighbours in space, so that searches find
// their data in the cache, and can share work.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// The numbers of the points in the order of a Hilbert curve through 1024^3 cells of their bounding box
// (Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004); points of one cell keep their
// order. Points that are not finite come first. A function of the points alone; uses all threads. Cost n.
std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points_mm);

}  // namespace trueblade
