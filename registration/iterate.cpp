#include "registration/iterate.h"

#include <algorithm>
#include <cmath>

#include "registration/closed_form.h"
#include "registration/determinacy.h"

namespace trueblade {
namespace {

constexpr int kHalvings = 10;  // a step a thousand times shorter than Gauss-Newton's leads nowhere

// A step that has been taken but not yet judged.
struct Trial {
  RigidTransform from;
  RigidTransform plain;  // where the step leads without acceleration
  Vec6 step_scaled;      // of the plain step
  StepFrame frame;
  std::vector<double> weights;  // of the correspondences that the step was computed from
  double objective;             // sum w d^2 that the new pose must not exceed
  bool accelerated;
  int halvings = 0;
};

StepFrame frame_at(const RigidTransform& part_from_mcs, const ScanExtent& extent) {
  return {part_from_mcs * extent.centroid_mcs_mm, extent.radius_mm};
}

double largest_motion_mm(const Vec6& step_scaled, const ScanExtent& extent) {
  return step_scaled.tail<3>().norm() +
         step_scaled.head<3>().norm() * extent.maximum_radius_mm / extent.radius_mm;
}

double weighted_squares(std::span<const double> distance, std::span<const double> weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < distance.size(); ++i) sum += weights[i] * distance[i] * distance[i];
  return sum;
}

double rms_of_eligible(const Correspondences& c) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.eligible[i]) {
      sum += c.distance_mm[i] * c.distance_mm[i];
      count += 1.0;
    }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

// The pose of the closed form for the selected point pairs; none when they lie on one line.
std::optional<RigidTransform> closed_form_pose(const RegistrationProblem& problem, const WorkingScan& scan,
                                               const Iterations& state) {
  std::vector<Vec3> nominal(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) nominal[i] = state.correspondences.closest[i].point_mm;
  const bool quaternion = problem.options.step.method == StepMethod::unit_quaternion;
  try {
    return quaternion ? absolute_orientation_by_quaternion(scan.position_mcs_mm, nominal, state.weights)
                      : absolute_orientation_by_svd(scan.position_mcs_mm, nominal, state.weights);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

double pair_squares(const WorkingScan& scan, const Iterations& state, const RigidTransform& pose) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (state.weights[i] > 0.0)
      sum += state.weights[i] *
             (pose * scan.position_mcs_mm[i] - state.correspondences.closest[i].point_mm).squaredNorm();
  return sum;
}

// Falls back from a trial that raised the objective; false when there is nothing left to try.
bool retreat(const RegistrationProblem& problem, Trial& trial, Accelerator& accelerator,
             RigidTransform& pose) {
  if (trial.accelerated) {
    trial.accelerated = false;
    accelerator.forget();
    pose = trial.plain;
    return true;
  }
  if (++trial.halvings > kHalvings) {
    pose = trial.from;
    return false;
  }
  pose = problem.motion.moved(trial.from, std::ldexp(1.0, -trial.halvings) * trial.step_scaled, trial.frame);
  return true;
}

void weigh(const WorkingScan& scan, Iterations& state) {
  state.base.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
    state.base[i] = state.correspondences.eligible[i] ? scan.weight[i] : 0.0;
  state.weights.resize(scan.size());
}

}  // namespace

std::optional<Termination> iterate(const RegistrationProblem& problem, const WorkingScan& scan, bool rough,
                                   Iterations& state) {
  const RegistrationOptions& options = problem.options;
  const bool closed_form = options.step.method != StepMethod::point_to_plane;
  CorrespondenceFinder finder(problem.target, options, scan.position_mcs_mm);
  Accelerator accelerator(options.acceleration, problem.extent.centroid_mcs_mm, problem.extent.radius_mm);
  std::optional<Trial> trial;
  std::optional<double> previous_rms;
  std::optional<Termination> outcome;
  Correspondences& c = state.correspondences;

  while (true) {
    const StepFrame frame = frame_at(state.part_from_mcs, problem.extent);
    finder.find(state.part_from_mcs, frame, c);
    ++state.iterations;
    if (state.iterations == 1) state.first_rms_mm = rms_of_eligible(c);
    const bool at_limit = state.iterations > options.termination.maximum_iterations;

    if (trial && (trial->accelerated || options.step.control) && !at_limit) {
      const double rounding = problem.floor_mm * problem.floor_mm * static_cast<double>(scan.size());
      if (weighted_squares(c.distance_mm, trial->weights) > trial->objective * (1.0 + 1e-12) + rounding) {
        if (retreat(problem, *trial, accelerator, state.part_from_mcs)) continue;
        outcome = Termination::no_descent;
      }
    }

    weigh(scan, state);
    const FreeDirections free = problem.motion.directions(state.part_from_mcs, frame);
    const NormalEquations all = normal_equations(c, state.base);
    const Determinacy determinacy = split_directions(all.hessian / std::max(all.weight, 1e-300), free, 1e-9);
    state.determined = determinacy.determined;
    state.undetermined = determinacy.undetermined;

    state.fit = fit_step(c, state.base, options.rejection, state.determined, problem.floor_mm, state.weights);
    const NormalEquations& equations = state.fit.equations;
    if (equations.count < std::max<std::size_t>(3, static_cast<std::size_t>(state.determined.cols())))
      outcome = Termination::too_few_correspondences;

    Trial next{state.part_from_mcs,
               state.part_from_mcs,
               state.fit.step_scaled,
               frame,
               state.weights,
               equations.weighted_squares,
               false};
    double rms_after = 0.0;
    if (!outcome && closed_form) {
      const auto pose = closed_form_pose(problem, scan, state);
      if (pose) {
        next.plain = *pose;
        next.step_scaled = frame.scaled(step_between(state.part_from_mcs, *pose, frame.pivot_part_mm));
        next.objective = pair_squares(scan, state, *pose);
        rms_after = std::sqrt(next.objective / equations.weight);
      } else {
        outcome = Termination::too_few_correspondences;
      }
    } else if (!outcome) {
      next.plain = problem.motion.moved(state.part_from_mcs, next.step_scaled, frame);
      const double predicted =
          equations.weighted_squares +
          next.step_scaled.dot(2.0 * equations.gradient + equations.hessian * next.step_scaled);
      rms_after = std::sqrt(std::max(0.0, predicted) / equations.weight);
    }
    if (at_limit && !outcome) outcome = Termination::iteration_limit;

    const Vec6 step = frame.unscaled(next.step_scaled);
    state.trace.push_back({state.part_from_mcs, equations.weighted_rms_mm(), equations.count,
                           step.head<3>().norm(), step.tail<3>().norm(), trial && trial->accelerated});
    if (outcome) break;

    // Why stop here? The step is still taken: by the criterion it is negligible.
    const double motion_mm = largest_motion_mm(next.step_scaled, problem.extent);
    const double rms = equations.weighted_rms_mm();
    const double variance = state.fit.scale.sigma_mm * state.fit.scale.sigma_mm;
    const double statistical =
        std::sqrt(next.step_scaled.dot(equations.hessian * next.step_scaled) *
                  static_cast<double>(equations.count) / equations.weight / (6.0 * variance));
    const TerminationOptions& limits = options.termination;
    bool done = rough && motion_mm <= options.sampling.until_step_sigma * state.fit.scale.sigma_mm;
    if (limits.statistical_step > 0.0 && statistical < limits.statistical_step)
      outcome = Termination::converged_statistically;
    else if (limits.rms_change_mm > 0.0 && previous_rms &&
             std::abs(*previous_rms - rms) < limits.rms_change_mm)
      outcome = Termination::converged_rms;
    else if (limits.step_mm > 0.0 && motion_mm <= limits.step_mm)
      outcome = Termination::converged_step;
    if (outcome || done) {
      state.part_from_mcs = next.plain;
      break;
    }

    previous_rms = rms;
    const auto further = accelerator.propose(next.from, next.plain, rms_after);
    next.accelerated = further.has_value();
    if (next.accelerated && !closed_form) next.objective = rms_after * rms_after * equations.weight;
    state.part_from_mcs = further.value_or(next.plain);
    trial = std::move(next);
  }
  state.work.queries += finder.work().queries;
  state.work.cache_hits += finder.work().cache_hits;
  state.work.facets_tested += finder.work().facets_tested;
  state.work.boxes_tested += finder.work().boxes_tested;
  return outcome;
}

}  // namespace trueblade
