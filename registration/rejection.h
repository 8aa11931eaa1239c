// Which correspondences take part, and with what weight (P6 and the rules the paper reviews).
#pragma once

#include <limits>
#include <span>
#include <string>

#include "registration/options.h"

namespace trueblade {

// The rule and its number, for reports.
std::string in_words(const RejectionOptions& options);

// What a rule found in the residuals.
struct RejectionScale {
  double sigma_mm = 0.0;                                    // robust standard deviation of the residuals
  double cut_mm = std::numeric_limits<double>::infinity();  // |residual| beyond it is rejected
};

// 1.4826 times the median of the unsigned residuals of the points with weight: the standard deviation of
// normal residuals, and bounded while fewer than half of the points are outliers. Of long scans every n-th
// point is taken, at least 4,096: the relative standard error is 1.17 / sqrt(4096) = 1.8 %.
double consistent_sigma_mm(std::span<const double> residual_mm, std::span<const double> weights);

// Applies `rule` to the residuals (signed distances, mm): weights[i] becomes base[i] times the rule's factor,
// 0 for rejected points. `floor_mm`, the rounding of a residual, keeps exact fits from rejecting each other.
// The least-median rule cuts at 2.5 sigma with the finite-sample correction of Rousseeuw and Leroy (1987);
// the search for its fit is in fit_step.h.
RejectionScale apply_rejection(const RejectionOptions& options, std::span<const double> residual_mm,
                               std::span<const double> base, double floor_mm, std::span<double> weights);

// Keeps the points within `cut_mm`: weights[i] becomes base[i] or 0.
void apply_cut(std::span<const double> residual_mm, std::span<const double> base, double cut_mm,
               std::span<double> weights);

}  // namespace trueblade
