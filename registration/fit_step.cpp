#include "registration/fit_step.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/parallel.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

constexpr std::size_t kBlock = 4096;
// The set of trusted points mostly repeats after two or three steps. A cut that is estimated from it may lead
// it round in a circle; under a cut that stays, the truncated sum of squares falls with every step, and the
// set must repeat.
constexpr int kStepsWithNewCut = 5;
constexpr int kConcentrationSteps = 20;
constexpr int kSubsets = 200;  // one in four subsets of six is clean among 20 % outliers: 1e-25 that none is

// distance + J . step, for all points.
std::vector<double> residuals_after(const Correspondences& c, const Vec6& step) {
  std::vector<double> residual(c.size());
  parallel_for_blocks(c.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    const double* j = c.jacobian.data() + 6 * begin;
    for (std::size_t i = begin; i < end; ++i, j += 6)
      residual[i] = c.distance_mm[i] + j[0] * step[0] + j[1] * step[1] + j[2] * step[2] + j[3] * step[3] +
                    j[4] * step[4] + j[5] * step[5];
  });
  return residual;
}

bool same_selection(std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if ((a[i] > 0.0) != (b[i] > 0.0)) return false;
  return true;
}

std::size_t selected(std::span<const double> weights) {
  return static_cast<std::size_t>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; }));
}

struct Regression {
  StepFit fit;
  std::vector<double> weights;  // those of fit.equations
  std::vector<double> residual;
};

// Applies the rule to the residuals: at a scale of their own, or at one that is held.
RejectionScale select(const RejectionOptions& options, const std::optional<RejectionScale>& held,
                      std::span<const double> residual_mm, std::span<const double> base, double floor_mm,
                      std::span<double> weights) {
  if (!held) return apply_rejection(options, residual_mm, base, floor_mm, weights);
  apply_cut(residual_mm, base, held->cut_mm, weights);
  return *held;
}

// The equations with the weights `next` in place of `now`, by the points alone that come or go. Those lie
// near the cut, as all others do: nothing large is added and taken away again.
void exchange_points(const Correspondences& c, std::span<const double> now, std::span<const double> next,
                     NormalEquations& equations) {
  std::vector<double> change(now.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = next[i] - now[i];
  equations += normal_equations(c, change);
  equations.count = selected(next);
}

Regression concentrate(const Correspondences& c, std::span<const double> base,
                       const RejectionOptions& options, const FreeDirections& free, double floor_mm,
                       bool settled, std::vector<double> start) {
  Regression r;
  r.weights = std::move(start);
  std::vector<double> next(r.weights.size());
  std::optional<RejectionScale> held;
  r.fit.equations = normal_equations(c, r.weights);
  for (int k = 1;; ++k) {
    r.fit.step_scaled = solve_step(r.fit.equations, free);
    r.residual = residuals_after(c, r.fit.step_scaled);
    r.fit.scale = select(options, held, r.residual, base, floor_mm, next);
    if (k == kConcentrationSteps || same_selection(r.weights, next)) return r;
    if (k == kStepsWithNewCut) held = r.fit.scale;
    if (settled) {
      exchange_points(c, r.weights, next, r.fit.equations);
    } else {
      r.fit.equations = normal_equations(c, next);
    }
    r.weights.swap(next);
  }
}

double truncated_objective(const Regression& r, std::span<const double> base, double cut) {
  double sum = 0.0;
  for (std::size_t i = 0; i < r.residual.size(); ++i)
    sum += base[i] * std::min(r.residual[i] * r.residual[i], cut * cut);
  return sum;
}

StepFit consistent_fit(const Correspondences& c, std::span<const double> base,
                       const RejectionOptions& options, const FreeDirections& free, double floor_mm,
                       bool settled, std::span<double> weights) {
  std::vector<double> near(base.size());
  apply_rejection(options, c.distance_mm, base, floor_mm, near);
  Regression best = concentrate(c, base, options, free, floor_mm, settled,
                                settled ? near : std::vector<double>(base.begin(), base.end()));
  // Fewer than one in a hundred cannot have carried the other start away.
  if (!settled && 100 * selected(best.weights) < 99 * selected(base)) {
    Regression other = concentrate(c, base, options, free, floor_mm, settled, std::move(near));
    const double cut = std::min(best.fit.scale.cut_mm, other.fit.scale.cut_mm);
    if (truncated_objective(other, base, cut) < truncated_objective(best, base, cut)) best = std::move(other);
  }
  std::copy(best.weights.begin(), best.weights.end(), weights.begin());
  return best.fit;
}

// A step through `subset` random points with weight.
Vec6 subset_step(const Correspondences& c, const std::vector<std::size_t>& used, const FreeDirections& free,
                 Rng& random) {
  NormalEquations equations;
  for (int k = 0; k < 6; ++k) {
    const auto pick = static_cast<std::size_t>(random.uniform() * static_cast<double>(used.size()));
    const std::size_t i = used[std::min(pick, used.size() - 1)];
    const auto j = c.jacobian.col(static_cast<Eigen::Index>(i));
    equations.hessian += j * j.transpose();
    equations.gradient += c.distance_mm[i] * j;
    equations.weight += 1.0;
  }
  return solve_step(equations, free);
}

StepFit least_median_fit(const Correspondences& c, std::span<const double> base,
                         const RejectionOptions& options, const FreeDirections& free, double floor_mm,
                         std::span<double> weights) {
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < base.size(); ++i)
    if (base[i] > 0.0) used.push_back(i);
  std::vector<double> best = c.distance_mm;
  double best_sigma = consistent_sigma_mm(best, base);
  Rng random(0, 0, "least median of squares");
  for (int k = 0; k < kSubsets && !used.empty(); ++k) {
    std::vector<double> residual = residuals_after(c, subset_step(c, used, free, random));
    const double sigma = consistent_sigma_mm(residual, base);
    if (sigma < best_sigma) {
      best_sigma = sigma;
      best = std::move(residual);
    }
  }
  StepFit fit;
  fit.scale = apply_rejection(options, best, base, floor_mm, weights);
  fit.equations = normal_equations(c, weights);
  fit.step_scaled = solve_step(fit.equations, free);
  return fit;
}

}  // namespace

StepFit fit_step(const Correspondences& correspondences, std::span<const double> base,
                 const RejectionOptions& options, const FreeDirections& free, double floor_mm, bool settled,
                 const std::optional<RejectionScale>& held_scale, std::span<double> weights) {
  if (options.rule == RejectionRule::consistent_cut && !held_scale)
    return consistent_fit(correspondences, base, options, free, floor_mm, settled, weights);
  if (options.rule == RejectionRule::least_median_of_squares)
    return least_median_fit(correspondences, base, options, free, floor_mm, weights);
  StepFit fit;
  fit.scale = select(options, held_scale, correspondences.distance_mm, base, floor_mm, weights);
  fit.equations = normal_equations(correspondences, weights);
  fit.step_scaled = solve_step(fit.equations, free);
  return fit;
}

}  // namespace trueblade
