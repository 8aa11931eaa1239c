// How well the signed deviation of each point is known.
#pragma once

#include <vector>

#include "inspection/deviations.h"
#include "registration/result.h"

namespace trueblade {

// Standard uncertainty of every signed deviation, mm: the point's own, `point_sigma_mm`, and the pose's,
// through the covariance C of the registration:
//   u_i^2 = point_sigma^2 + J_i C J_i^T,   J_i = [ (p_i - pivot) x n_i , n_i ].
// The two parts are added although a point that took part in the fit pulls the pose towards itself, which
// makes its deviation smaller: an upper bound for these points, right for all others.
std::vector<double> deviation_uncertainty_mm(const Deviations& deviations,
                                             const RegistrationResult& registration, double point_sigma_mm);

}  // namespace trueblade
