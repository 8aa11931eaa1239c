#include "registration/iterate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "registration/acceleration.h"
#include "registration/closed_form.h"
#include "registration/determinacy.h"

namespace trueblade {
namespace {

constexpr int kHalvings = 10;  // a step a thousand times shorter than Gauss-Newton's leads nowhere
constexpr int kHalvingsBeforeHolding = 2;

// Of sigma, 5 %: three standard errors of the 4,096 points that it is estimated from.
constexpr double kScaleChange = 0.05;
constexpr int kStepsWithNewScale = 20;  // most registrations end before

// Of the pose's own standard uncertainty: near the minimum for what comes next.
constexpr double kInsignificant = 0.3;

// A step that takes back more than this share of the last one went too far: each is then at least half as
// long as the one before.
constexpr double kTakenBack = 0.5;
constexpr double kLeastRelaxation = 0.1;  // for steps that go ten times too far

// A step that was taken and is judged at the next look.
struct Trial {
  RigidTransform from;
  RigidTransform to;      // where the step leads without acceleration
  Vec6 step_scaled;       // from -> to
  Vec6 full_step_scaled;  // the same before relaxation
  StepFrame frame;
  // What the step must not raise: sum w min(d, cut)^2, with everything but the distances d held.
  std::vector<double> weights;
  double cut_mm;
  double objective_at_from_mm2;
  double limit_mm2;     // the objective at `from`; for an accelerated pose, what is expected of `to`
  double rms_after_mm;  // of the linear model or of the point pairs, at `to`
  bool of_held_scale = false;
  bool accelerated = false;
  int halvings = 0;
};

double truncated_squares(std::span<const double> distance_mm, std::span<const double> weights,
                         double cut_mm) {
  const double cut_mm2 = cut_mm * cut_mm;
  double sum = 0.0;
  for (std::size_t i = 0; i < distance_mm.size(); ++i)
    sum += weights[i] * std::min(distance_mm[i] * distance_mm[i], cut_mm2);
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

// Of the robust scale. Where facets stand in for CAD surfaces, planes fit them to the last digit, and by that
// measure the facets' chord error everywhere else is an outlier: the cut must not fall below it.
double scale_floor_mm(const RegistrationProblem& problem, bool exact) {
  const Part& part = problem.target.part();
  if (exact || !part.exact || problem.options.rejection.rule != RejectionRule::consistent_cut)
    return problem.floor_mm;
  return std::max(problem.floor_mm, part.chord_tolerance_mm / problem.options.rejection.cut_sigma);
}

class Iteration {
 public:
  Iteration(const RegistrationProblem& problem, const WorkingScan& scan, bool exact, RegistrationState& state)
      : problem_(problem),
        options_(problem.options),
        scan_(scan),
        state_(state),
        finder_(problem.target, problem.options, scan.position_mcs_mm, exact),
        scale_floor_mm_(scale_floor_mm(problem, exact)),
        accelerator_(problem.options.acceleration, problem.extent.centroid_mcs_mm, problem.extent.radius_mm) {
  }

  std::optional<Termination> run(IterationGoal goal) {
    look();
    while (true) {
      if (rose_since_the_last_step()) {
        if (state_.iterations >= options_.termination.maximum_iterations)
          return stop(Termination::iteration_limit);
        if (!retreat()) return stop(Termination::no_descent);
        look();
        continue;
      }
      const std::optional<Trial> step = next_step();
      if (!step) return Termination::too_few_correspondences;
      // Spent on other points already: these were looked at, and that is all.
      if (state_.iterations >= options_.termination.maximum_iterations) return Termination::iteration_limit;
      record(*step);
      if (state_.iterations >= options_.termination.maximum_iterations) return Termination::iteration_limit;
      const auto reason = reason_to_stop(*step);
      state_.settled =
          largest_motion_mm(*step) <= options_.sampling.until_step_sigma * state_.fit.scale.sigma_mm;
      const bool near =
          goal == IterationGoal::near_the_minimum && (state_.settled || is_insignificant(*step));
      if (near || (reason && !more_is_undetermined() && !released_an_old_scale())) {
        state_.part_from_mcs = step->to;  // by the criterion it hardly differs
        return reason;
      }
      take(*step);
      look();
    }
  }

  const ClosestPointWork& work() const { return finder_.work(); }

 private:
  void look() {
    finder_.find(state_.part_from_mcs,
                 {state_.part_from_mcs * problem_.extent.centroid_mcs_mm, problem_.extent.radius_mm},
                 correspondences());
    state_.base.resize(scan_.size());
    state_.weights.resize(scan_.size());
    // A point at the border of the surfaces that take part may come with one pose and go with the next, and
    // lead the iteration round in a circle. While the scale is held, a point that has gone stays away.
    for (std::size_t i = 0; i < scan_.size(); ++i) {
      const bool stays_away = held_scale_ && state_.base[i] == 0.0;
      state_.base[i] = correspondences().eligible[i] && !stays_away ? scan_.weight[i] : 0.0;
    }
    if (state_.trace.empty()) state_.first_rms_mm = rms_of_eligible(correspondences());
  }

  // Step control. Rounding may raise an objective that is at its minimum already.
  bool rose_since_the_last_step() const {
    if (!trial_ || !(trial_->accelerated || options_.step.control)) return false;
    const double rounding = problem_.floor_mm * problem_.floor_mm * static_cast<double>(scan_.size());
    return truncated_squares(state_.correspondences.distance_mm, trial_->weights, trial_->cut_mm) >
           trial_->limit_mm2 * (1.0 + 1e-12) + rounding;
  }

  // Back to the plain step, or to half of it. The step for the points that it explains itself need not lead
  // downhill for all points, however short; under its scale, held, the step for the points that are near now
  // does.
  bool retreat() {
    ++state_.iterations;
    if (trial_->accelerated) {
      trial_->accelerated = false;
      trial_->limit_mm2 = trial_->objective_at_from_mm2;
      accelerator_.forget();
      state_.part_from_mcs = trial_->to;
      return true;
    }
    const bool may_hold = options_.rejection.rule == RejectionRule::consistent_cut && !trial_->of_held_scale;
    if (++trial_->halvings > (may_hold ? kHalvingsBeforeHolding : kHalvings)) {
      if (!may_hold) return false;
      held_scale_ = state_.fit.scale;
      state_.part_from_mcs = trial_->from;
      trial_.reset();
      previous_rms_mm_.reset();
      return true;
    }
    const double fraction = std::ldexp(1.0, -trial_->halvings);
    state_.part_from_mcs = problem_.motion.moved(trial_->from, fraction * trial_->step_scaled, trial_->frame);
    return true;
  }

  // Back where the last step began, with everything known there.
  Termination stop(Termination termination) {
    state_.part_from_mcs = trial_->from;
    look();
    next_step();
    return termination;
  }

  // The directions that may move. The scan is asked at the first look and, if it determines everything there,
  // again only before the end.
  void split_directions_here() {
    const FreeDirections free = problem_.motion.directions(state_.part_from_mcs, correspondences().frame);
    if (state_.asked_what_is_determined && state_.all_determined) {
      state_.determined = free;
      return;
    }
    const SurfaceInformation information =
        surface_information(problem_.target.model(), correspondences(), state_.base);
    const Determinacy determinacy = split_directions(information, free, problem_.frozen);
    state_.determined = determinacy.determined;
    state_.undetermined = determinacy.undetermined;
    state_.asked_what_is_determined = true;
    state_.all_determined = determinacy.undetermined.cols() == 0;
  }

  bool more_is_undetermined() {
    if (!state_.all_determined) return false;
    state_.asked_what_is_determined = false;
    split_directions_here();
    return !state_.all_determined;
  }

  std::optional<Trial> next_step() {
    split_directions_here();
    state_.fit = fit_step(correspondences(), state_.base, options_.rejection, state_.determined,
                          scale_floor_mm_, state_.settled, held_scale_, state_.weights);
    const NormalEquations& equations = state_.fit.equations;
    if (equations.count < std::max<std::size_t>(3, static_cast<std::size_t>(state_.determined.cols())))
      return std::nullopt;
    Trial trial;
    trial.from = state_.part_from_mcs;
    trial.frame = correspondences().frame;
    trial.of_held_scale = held_scale_.has_value();
    set_objective(trial);
    return options_.step.method == StepMethod::point_to_plane ? plane_step(trial) : closed_form_step(trial);
  }

  // The consistent cut trusts the points that the step explains, not those that are near now. Its objective
  // counts every point, one beyond the cut as if it were at it. The other rules weigh the distances here, and
  // where the sum of squares with these weights falls, so does the rule's own objective (Tukey's and Welsch's
  // as well as a truncated one; a majorisation). The least median selects by a step of its own: it answers
  // for its selection.
  void set_objective(Trial& trial) const {
    const bool cuts_after_the_step = options_.rejection.rule == RejectionRule::consistent_cut;
    trial.weights = cuts_after_the_step ? state_.base : state_.weights;
    trial.cut_mm = cuts_after_the_step ? state_.fit.scale.cut_mm : std::numeric_limits<double>::infinity();
    trial.objective_at_from_mm2 =
        truncated_squares(state_.correspondences.distance_mm, trial.weights, trial.cut_mm);
    trial.limit_mm2 = trial.objective_at_from_mm2;
  }

  std::optional<Trial> plane_step(Trial& trial) const {
    const NormalEquations& equations = state_.fit.equations;
    trial.step_scaled = trial.full_step_scaled = state_.fit.step_scaled;
    trial.to = problem_.motion.moved(trial.from, trial.step_scaled, trial.frame);
    const double predicted =
        equations.weighted_squares +
        trial.step_scaled.dot(2.0 * equations.gradient + equations.hessian * trial.step_scaled);
    trial.rms_after_mm = std::sqrt(std::max(0.0, predicted) / equations.weight);
    return trial;
  }

  std::optional<Trial> closed_form_step(Trial& trial) const {
    std::vector<Vec3> nominal(scan_.size());
    for (std::size_t i = 0; i < scan_.size(); ++i) nominal[i] = state_.correspondences.closest[i].point_mm;
    try {
      trial.to = options_.step.method == StepMethod::unit_quaternion
                     ? absolute_orientation_by_quaternion(scan_.position_mcs_mm, nominal, state_.weights)
                     : absolute_orientation_by_svd(scan_.position_mcs_mm, nominal, state_.weights);
    } catch (const InputError&) {  // the points that are left lie on one line
      return std::nullopt;
    }
    trial.step_scaled = trial.frame.scaled(step_between(trial.from, trial.to, trial.frame.pivot_part_mm));
    if (state_.undetermined.cols() > 0) {  // the point pairs hold every point where it is: no motion there
      trial.step_scaled = state_.determined * (state_.determined.transpose() * trial.step_scaled);
      trial.to = problem_.motion.moved(trial.from, trial.step_scaled, trial.frame);
    }
    double squares = 0.0;
    for (std::size_t i = 0; i < scan_.size(); ++i)
      squares += state_.weights[i] * (trial.to * scan_.position_mcs_mm[i] - nominal[i]).squaredNorm();
    trial.rms_after_mm = std::sqrt(squares / state_.fit.equations.weight);
    return trial;
  }

  void record(const Trial& step) {
    const Vec6 unscaled = step.frame.unscaled(step.step_scaled);
    state_.trace.push_back({step.from, state_.fit.equations.weighted_rms_mm(), state_.fit.equations.count,
                            unscaled.head<3>().norm(), unscaled.tail<3>().norm(), state_.fit.scale.cut_mm,
                            trial_ && trial_->accelerated});
    ++state_.iterations;
  }

  double largest_motion_mm(const Trial& step) const {
    return step.step_scaled.tail<3>().norm() +
           step.step_scaled.head<3>().norm() * problem_.extent.maximum_radius_mm / problem_.extent.radius_mm;
  }

  // sqrt(step' H step / (6 sigma^2)), H per unit of mean weight.
  double statistical_length(const Trial& step) const {
    const NormalEquations& equations = state_.fit.equations;
    const double mean_weight = equations.weight / static_cast<double>(equations.count);
    const double sigma = state_.fit.scale.sigma_mm;
    return std::sqrt(step.step_scaled.dot(equations.hessian * step.step_scaled) / mean_weight / 6.0) / sigma;
  }

  // Along a direction that the points hardly determine a step stays long, and on facets it wanders from one
  // to the next, although the objective tells nothing any more.
  bool is_insignificant(const Trial& step) const {
    return options_.step.method == StepMethod::point_to_plane && statistical_length(step) < kInsignificant;
  }

  std::optional<Termination> reason_to_stop(const Trial& step) {
    const TerminationOptions& limits = options_.termination;
    const double rms_mm = state_.fit.equations.weighted_rms_mm();
    const auto previous_rms_mm = std::exchange(previous_rms_mm_, rms_mm);
    if (limits.statistical_step > 0.0 && statistical_length(step) < limits.statistical_step)
      return Termination::converged_statistically;
    if (limits.rms_change_mm > 0.0 && previous_rms_mm &&
        std::abs(*previous_rms_mm - rms_mm) < limits.rms_change_mm)
      return Termination::converged_rms;
    if (limits.step_mm > 0.0 && largest_motion_mm(step) <= limits.step_mm) return Termination::converged_step;
    return std::nullopt;
  }

  // A scale that follows every step can lead the selection round in a circle of poses. Near the minimum it is
  // therefore held, and estimated again when the iteration has converged with it.
  bool released_an_old_scale() {
    if (!held_scale_) return false;
    const double sigma_mm =
        std::max(consistent_sigma_mm(correspondences().distance_mm, state_.base), scale_floor_mm_);
    const double held_mm = held_scale_->sigma_mm;
    const auto is_held = [&](double other_mm) {
      return std::abs(other_mm - held_mm) <= kScaleChange * held_mm;
    };
    // Where residuals are far from normal, what the fit selects by a scale need not have that scale: once
    // estimated anew and held again, it will come out so every time.
    if (is_held(sigma_mm) || std::any_of(released_mm_.begin(), released_mm_.end(), is_held)) return false;
    released_mm_.push_back(held_mm);
    held_scale_.reset();
    return true;
  }

  // Gauss and Newton leave out that the surface bends away under a point at a distance. Where a misfit keeps
  // distances at small radii, their step goes too far, and back, and so on. Two such steps tell where between
  // them there would be none: Aitken's relaxation (Kuettler and Wall 2008, eq. 43), in the metric of the
  // objective. A relaxed iteration stays so.
  void relax(const Trial& last, Trial& step) {
    if (options_.step.method != StepMethod::point_to_plane ||
        options_.acceleration.method != AccelerationMethod::none)
      return;
    const Vec6 moved = step.frame.scaled(step_between(last.from, step.from, last.frame.pivot_part_mm));
    const Mat6& metric = state_.fit.equations.hessian;
    const bool goes_back = -moved.dot(metric * step.step_scaled) > kTakenBack * moved.dot(metric * moved);
    if (relaxation_ == 1.0 && !goes_back) return;
    const Vec6 change = step.full_step_scaled - last.full_step_scaled;
    const double change_squared = change.dot(metric * change);
    if (change_squared > 0.0)
      relaxation_ = std::clamp(-moved.dot(metric * change) / change_squared, kLeastRelaxation, 1.0);
    step.step_scaled *= relaxation_;
    step.to = problem_.motion.moved(step.from, step.step_scaled, step.frame);
  }

  void take(Trial step) {
    if (trial_) relax(*trial_, step);
    trial_ = step;
    if (!state_.settled) ++unsettled_steps_;
    const bool hold = state_.settled || unsettled_steps_ > kStepsWithNewScale;
    if (options_.rejection.rule == RejectionRule::consistent_cut && hold && !held_scale_)
      held_scale_ = state_.fit.scale;
    const auto further = accelerator_.propose(step.from, step.to, step.rms_after_mm);
    state_.part_from_mcs = further.value_or(step.to);
    trial_->accelerated = further.has_value();
    if (further) {
      trial_->limit_mm2 = step.rms_after_mm * step.rms_after_mm * state_.fit.equations.weight;
      for (std::size_t i = 0; i < scan_.size(); ++i)  // those that the cut left out
        if (state_.weights[i] == 0.0 && trial_->weights[i] > 0.0)
          trial_->limit_mm2 += trial_->weights[i] * trial_->cut_mm * trial_->cut_mm;
    }
  }

  Correspondences& correspondences() { return state_.correspondences; }

  const RegistrationProblem& problem_;
  const RegistrationOptions& options_;
  const WorkingScan& scan_;
  RegistrationState& state_;
  CorrespondenceFinder finder_;
  double scale_floor_mm_;
  Accelerator accelerator_;
  std::optional<Trial> trial_;
  std::optional<double> previous_rms_mm_;
  double relaxation_ = 1.0;
  int unsettled_steps_ = 0;
  std::optional<RejectionScale> held_scale_;  // while the iteration converges
  std::vector<double> released_mm_;           // scales that were held before
};

}  // namespace

std::optional<Termination> iterate(const RegistrationProblem& problem, const WorkingScan& scan,
                                   IterationGoal goal, bool exact, RegistrationState& state) {
  Iteration iteration(problem, scan, exact, state);
  const auto termination = iteration.run(goal);
  state.work += iteration.work();
  return termination;
}

}  // namespace trueblade
