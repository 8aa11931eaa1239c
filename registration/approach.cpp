#include "registration/approach.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trueblade {
namespace {

// A misfit leaves distances of the size of those at the start; below a tenth of them the start has explained
// what there was.
constexpr double kMisfitShare = 0.1;
// Starts lie these many times the first RMS distance away: a surface that is hit at an angle is nearer than
// the displacement, and points on a wrong surface are nearer still.
constexpr double kStartDistances[] = {2.0, 5.0};

// Over all points that are eligible: outliers of a good pose weigh no more than those of another.
double mean_distance_mm(const RegistrationState& state) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < state.base.size(); ++i) {
    sum += state.base[i] * std::abs(state.correspondences.distance_mm[i]);
    weight += state.base[i];
  }
  return weight > 0.0 ? sum / weight : std::numeric_limits<double>::infinity();
}

bool shows_misfit(const FacetModel& model, const RegistrationState& state) {
  return mean_distance_mm(state) > kMisfitShare * state.first_rms_mm &&
         neighbour_correlation(model, state) > kMisfitCorrelation;
}

// One more start. Where it ends better than `state` it takes its place.
void start_from(const RegistrationProblem& problem, const WorkingScan& scan,
                const RigidTransform& part_from_mcs, RegistrationState& state) {
  RegistrationState other;
  other.part_from_mcs = part_from_mcs;
  iterate(problem, scan, IterationGoal::near_the_minimum, false, other);
  ClosestPointWork work = state.work;
  work += other.work;
  if (mean_distance_mm(other) < mean_distance_mm(state)) {
    other.first_rms_mm = state.first_rms_mm;
    state = std::move(other);
  }
  state.work = work;
}

}  // namespace

double neighbour_correlation(const FacetModel& model, const RegistrationState& state) {
  constexpr std::size_t kEnough = 4096, kRun = 64;
  const Correspondences& c = state.correspondences;
  const std::size_t every = std::max<std::size_t>(1, state.weights.size() / kEnough);
  double product = 0.0, square = 0.0, previous = 0.0;  // 0: there is none
  for (std::size_t i = 0; i < state.weights.size(); ++i) {
    if (i / kRun % every != 0) {
      i += kRun - 1;
      previous = 0.0;
      continue;
    }
    if (!(state.weights[i] > 0.0)) continue;
    // The distance counts along the way from the closest point, which is the normal or its opposite.
    const Vec3 way = c.jacobian.col(static_cast<Eigen::Index>(i)).tail<3>();
    const bool outward = way.dot(model.facet_normal(c.closest[i].facet)) >= 0.0;
    const double d = outward ? c.distance_mm[i] : -c.distance_mm[i];
    product += d * previous;
    square += d * d;
    previous = d;
  }
  return square > 0.0 ? product / square : 0.0;
}

void approach(const RegistrationProblem& problem, const WorkingScan& scan, RegistrationState& state) {
  const RigidTransform initial = state.part_from_mcs;
  iterate(problem, scan, IterationGoal::near_the_minimum, false, state);
  const FreeDirections around = state.determined;
  const StepFrame frame{initial * problem.extent.centroid_mcs_mm, problem.extent.radius_mm};
  for (const double times : kStartDistances)
    for (Eigen::Index k = 0; k < around.cols(); ++k)
      for (const double side : {1.0, -1.0}) {
        if (!shows_misfit(problem.target.model(), state)) return;
        const Vec6 away = side * times * state.first_rms_mm * around.col(k);
        start_from(problem, scan, problem.motion.moved(initial, away, frame), state);
      }
}

}  // namespace trueblade
