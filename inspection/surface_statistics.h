// Statistics per CAD surface of the part.
#pragma once

#include <vector>

#include "inspection/deviations.h"
#include "inspection/result.h"
#include "part/part.h"

namespace trueblade {

// One entry for every surface on which points were measured, in the order of the surfaces; report outliers
// are left out of the numbers and counted. With a tolerance, the points are counted against it.
std::vector<SurfaceStatistics> statistics_by_surface(const Part& part, const Deviations& deviations,
                                                     const std::optional<Tolerance>& tolerance);

}  // namespace trueblade
