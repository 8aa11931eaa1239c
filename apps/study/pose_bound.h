// The Cramer-Rao bound of a registered pose: no unbiased estimate from these points scatters less.
#pragma once

#include "apps/study/view_quantities.h"

namespace trueblade {

// Standard deviations (rotation about the axes of the part in rad, then translation of `pivot_mm` in mm). The
// sensor's noise alone is taken as random, point by point with its true standard deviation along the beam, of
// which cos(incidence) falls on the normal: information = sum of J J' / (sigma cos(incidence))^2 with
// J = ((p - pivot) x n, n). A sensor without noise has no bound: NaN.
Vec6 pose_bound(const Scenario& scenario, const FacetModel& model, const RegisteredPoints& registered,
                const Vec3& pivot_mm);

}  // namespace trueblade
