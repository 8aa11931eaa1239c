#include "registration/register_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/error.h"
#include "registration/approach.h"
#include "registration/covariance.h"
#include "registration/cross_check.h"
#include "registration/determinacy.h"
#include "registration/iterate.h"

namespace trueblade {
namespace {

// Far from the part it is wrong correspondences, not noise, that limit a step: some hundred points tell as
// much as all.
constexpr std::size_t kFirstSample = 400;

// Rounding of a distance: a handful of operations on the largest coordinate in play, 64 ulps of it.
double rounding_floor_mm(const RegistrationTarget& target, const ScanExtent& extent,
                         const RigidTransform& part_from_mcs) {
  const double largest = std::max({target.lower_corner_mm().norm(), target.upper_corner_mm().norm(),
                                   (part_from_mcs * extent.centroid_mcs_mm).norm() + extent.maximum_radius_mm,
                                   extent.centroid_mcs_mm.norm() + extent.maximum_radius_mm});
  return 64.0 * std::numeric_limits<double>::epsilon() * largest;
}

// Ten times the sizes of part and scan together is no placement by any machine set-up: the unit or the
// initial pose is wrong, and every point would see the part from the same side.
void check_near(const RegistrationTarget& target, const ScanExtent& extent,
                const RigidTransform& part_from_mcs) {
  if (!is_finite(part_from_mcs)) throw InputError("the initial pose holds a number that is not finite");
  const Vec3 &low = target.lower_corner_mm(), &high = target.upper_corner_mm();
  const Vec3 centroid = part_from_mcs * extent.centroid_mcs_mm;
  const double gap = (centroid - centroid.cwiseMax(low).cwiseMin(high)).norm();
  const double size = (high - low).norm() + 2.0 * extent.maximum_radius_mm;
  if (!(gap <= 10.0 * size))
    throw InputError(fmt::format(
        "the scan's centroid lies {:.6g} mm from the part, whose size with the scan's is {:.6g} mm, at the "
        "initial pose: check the initial pose and the units",
        gap, size));
}

// The options may leave too few points to the registration.
void check_selection(const FacetModel& model, const RegistrationState& state,
                     const RegistrationOptions& options) {
  const Correspondences& c = state.correspondences;
  if (std::count(c.eligible.begin(), c.eligible.end(), 1) >= 3) return;
  const auto on_selected =
      std::count_if(c.closest.begin(), c.closest.end(), [&](const ClosestPoint& closest) {
        const std::uint32_t surface = model.surface_of(closest.facet);
        return options.surfaces.empty() ||
               std::count(options.surfaces.begin(), options.surfaces.end(), surface) > 0;
      });
  if (on_selected < 3)
    throw InputError(
        fmt::format("surfaces [{}]: {} of {} points are closest to them; at least three are needed",
                    fmt::join(options.surfaces, ", "), on_selected, c.size()));
  if (options.rejection.boundary == BoundaryPolicy::reject)
    throw InputError(
        fmt::format("rejection.boundary reject leaves {} of {} points, whose closest points lie off the "
                    "part's border; at "
                    "least three are needed",
                    std::count(c.eligible.begin(), c.eligible.end(), 1), on_selected));
}

bool uses_exact_surfaces(const RegistrationProblem& problem) {
  return problem.options.exact_surfaces && problem.target.part().exact;
}

double unweighted_rms_mm(const RegistrationState& state) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < state.weights.size(); ++i)
    if (state.weights[i] > 0.0) {
      sum += state.correspondences.distance_mm[i] * state.correspondences.distance_mm[i];
      count += 1.0;
    }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

Vec3 inlier_centroid_mcs(const WorkingScan& scan, const std::vector<double>& weights) {
  Vec3 sum = Vec3::Zero();
  double weight = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    sum += weights[i] * scan.position_mcs_mm[i];
    weight += weights[i];
  }
  return weight > 0.0 ? Vec3(sum / weight) : extent_of(scan).centroid_mcs_mm;
}

void report_covariance(const RegistrationState& state, const WorkingScan& scan,
                       const PoseCovariance& covariance, RegistrationResult& result) {
  const StepFrame& frame = state.correspondences.frame;
  Vec6 unscale;
  unscale << Vec3::Constant(1.0 / frame.radius_mm), Vec3::Ones();
  const Mat6 tangent = unscale.asDiagonal() * covariance.scaled * unscale.asDiagonal();
  result.centroid_part_mm = state.part_from_mcs * inlier_centroid_mcs(scan, state.weights);
  result.covariance = covariance_about_pivot(tangent, frame.pivot_part_mm, result.centroid_part_mm);
  result.sigma_mm = covariance.sigma_mm;
  result.sigma_estimated = covariance.sigma_estimated;
  result.undetermined = describe_undetermined(state.undetermined, frame);
}

RegistrationResult report(const FacetModel& model, const WorkingScan& scan, std::size_t scan_size,
                          const RegistrationState& state, const PoseCovariance& covariance,
                          Termination termination) {
  RegistrationResult result;
  result.part_from_mcs = state.part_from_mcs;
  result.termination = termination;
  result.iterations = state.iterations;
  result.trace = state.trace;
  result.work = state.work;
  result.is_inlier.assign(scan_size, false);
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (state.weights[i] > 0.0) {
      result.is_inlier[scan.scan_index[i]] = true;
      ++result.inliers;
    }
  result.outliers = scan_size - result.inliers;
  result.first_rms_mm = state.first_rms_mm;
  result.weighted_rms_mm = state.fit.equations.weighted_rms_mm();
  result.rms_mm = unweighted_rms_mm(state);
  // A nanometre is nobody's misfit: what a fit without noise leaves.
  constexpr double kNothing_mm = 1e-6;
  result.shows_misfit =
      result.rms_mm > kNothing_mm && neighbour_correlation(model, state) > kMisfitCorrelation;
  report_covariance(state, scan, covariance, result);
  return result;
}

CrossCheck cross_check_of(const RegistrationProblem& problem, const WorkingScan& scan,
                          const RegistrationState& state, const PoseCovariance& covariance) {
  std::vector<Vec3> closest_part_mm;
  for (const ClosestPoint& closest : state.correspondences.closest)
    closest_part_mm.push_back(closest.point_mm);
  const RegistrationOptions& options = problem.options;
  const bool is_plain =
      options.covariance.noise == NoiseModel::equal &&
      (options.rejection.rule == RejectionRule::none ||
       options.rejection.rule == RejectionRule::consistent_cut) &&
      std::all_of(state.weights.begin(), state.weights.end(), [](double w) { return w == 0.0 || w == 1.0; });
  return cross_check_registration(
      {problem.target, uses_exact_surfaces(problem), scan.position_mcs_mm, closest_part_mm, state.weights,
       state.part_from_mcs, state.correspondences.frame, state.determined, covariance.scaled,
       state.fit.equations.hessian, is_plain ? std::optional(covariance.sigma_mm) : std::nullopt});
}

// Near the minimum on the facets first, by subsamples, each at most half of what follows it, or without them
// by all points; then all points on the best surface there is.
Termination register_from(const RegistrationProblem& problem, const WorkingScan& scan,
                          RegistrationState& state) {
  const auto sample = static_cast<std::size_t>(problem.options.sampling.points);
  const bool sampled = sample > 0 && scan.size() >= 2 * sample;
  const bool exact = uses_exact_surfaces(problem);
  if (sample > 0)
    approach(problem, scan.size() >= 2 * kFirstSample ? even_subsample(scan, kFirstSample) : scan, state);
  if (sampled)
    iterate(problem, even_subsample(scan, sample), IterationGoal::near_the_minimum, false, state);
  else if (exact && sample == 0)
    iterate(problem, scan, IterationGoal::near_the_minimum, false, state);
  return iterate(problem, scan, IterationGoal::termination, exact, state).value();
}

}  // namespace

RegistrationResult register_scan(const RegistrationTarget& target, const ScanPoints& scan,
                                 const RigidTransform& initial_part_from_mcs,
                                 const RegistrationOptions& options) {
  options.validate();
  const WorkingScan all = prepare_scan(scan, options.weights);
  const ScanExtent extent = extent_of(all);
  check_not_collinear(extent);
  check_near(target, extent, initial_part_from_mcs);
  RegistrationProblem problem{target, options, LockedMotion(options.lock, initial_part_from_mcs), extent,
                              rounding_floor_mm(target, extent, initial_part_from_mcs)};
  while (true) {
    RegistrationState state;
    state.part_from_mcs = initial_part_from_mcs;
    const Termination termination = register_from(problem, all, state);
    check_selection(target.model(), state, options);
    const PoseCovariance covariance = pose_covariance(state.correspondences, state.base, state.weights,
                                                      state.fit.scale, state.determined, options);
    // A scan that slides about may never converge: it is asked all the same.
    const Eigen::Index weak = weakly_determined(covariance.scaled, state.determined, extent.radius_mm);
    if (weak == 0) {
      RegistrationResult result = report(target.model(), all, scan.size(), state, covariance, termination);
      if (options.cross_check) result.cross_check = cross_check_of(problem, all, state, covariance);
      return result;
    }
    // Known only now, and moved already: once more from the start, without these directions.
    problem.frozen = state.undetermined.cols() + weak;
  }
}

}  // namespace trueblade
