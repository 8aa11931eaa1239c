// How far the facets really are from the exact surfaces.
#pragma once

#include <optional>
#include <vector>

#include "part/part.h"

namespace trueblade {

// Largest distance between facet and exact surface, one entry per surface, measured at each facet's centre
// and at the middles of its edges (where a chord of a curve of even curvature is farthest away). Samples
// whose projection does not converge are left out. nullopt for a part without exact surfaces.
std::optional<std::vector<double>> chord_errors_mm(const Part& part);

}  // namespace trueblade
