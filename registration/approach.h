// The way from the initial pose to the neighbourhood of the minimum, on a few hundred points.
//
// Far from the part many correspondences are wrong, and the iteration may end in a minimum where one part of
// the scan fits and the rest does not. Noise tells neighbours nothing about one another; a misfit does. So
// where the residuals that are left are large against those at the start and agree from neighbour to
// neighbour, the iteration begins again from poses around the initial one, and the end with the least mean
// distance is kept. A part with form errors looks the same and costs the same starts, but ends where it did.
#pragma once

#include "registration/iterate.h"

namespace trueblade {

// Noise correlates to 1 / sqrt(n), 0.05 for 400 points; a misfit nearly fully.
inline constexpr double kMisfitCorrelation = 0.5;

// Correlation of the signed residuals (positive outside the material) of neighbouring points that take part;
// of long scans some 4,096 of them, in runs, tell as much as all.
double neighbour_correlation(const FacetModel& model, const RegistrationState& state);

// Moves `state` from the initial pose to near the best minimum found on `scan` (spatial order). Where no
// minimum shows a misfit this is one iterate() to near_the_minimum. state.work counts all starts,
// state.iterations those of the start that was kept.
void approach(const RegistrationProblem& problem, const WorkingScan& scan, RegistrationState& state);

}  // namespace trueblade
