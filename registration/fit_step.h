// The step of one iteration: which correspondences are trusted, and the Gauss-Newton step they give.
#pragma once

#include <optional>

#include "registration/normal_equations.h"
#include "registration/rejection.h"

namespace trueblade {

struct StepFit {
  Vec6 step_scaled = Vec6::Zero();  // in the correspondences' frame
  NormalEquations equations;        // over the correspondences that take part
  RejectionScale scale;
};

// Selects and solves. `base` are the weights before rejection, `weights` receives those after it.
//
// A point far from the part may be an outlier, or it may be the only one that sees the direction in which the
// scan is misplaced (the platform of a blade, when the scan is too high). The residual at the present pose
// cannot tell these apart, the residual after the best step can. The consistent cut therefore alternates
// between the step for the trusted points and the points that the step explains within the cut
// (concentration steps, Rousseeuw and Van Driessen 1999), once starting from all points and, where that
// rejects more than 1 %, once from those that are near now; the start that leaves the lower truncated
// objective wins. When the pose has `settled` (the last step was small against sigma) the present residuals
// do tell the outliers apart, and the points that are near now are the only start. With a
// `held_scale` the points within its cut now take part, and the step is theirs: then the truncated sum of
// squares falls from step to step (a majorisation), and the iteration cannot go round in a circle. The
// least-median rule takes the best of 200 steps through six random points each. Neither needs new closest
// points. The other rules judge the residuals as they are.
StepFit fit_step(const Correspondences& correspondences, std::span<const double> base,
                 const RejectionOptions& options, const FreeDirections& free, double floor_mm, bool settled,
                 const std::optional<RejectionScale>& held_scale, std::span<double> weights);

}  // namespace trueblade
