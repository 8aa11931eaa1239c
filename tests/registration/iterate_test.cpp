// Step control: the default's robust objective, computed here anew from the poses alone, never rises.
#include "registration/iterate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "part/turbine_blade.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kDegree = shapes::kPi / 180.0;
const Vec3 kView(0.3, 1.0, 0.4);

// One scan of a part, from far or near, with or without every fifth point a gross outlier.
struct Situation {
  double sigma_mm;
  bool outliers;
  double away;  // mm, and degrees
  std::uint64_t trial;

  std::vector<Vec3> points(const Part& part, std::size_t count) const {
    std::vector<Vec3> points = shapes::points_on(part, count, kView, sigma_mm, 1, trial);
    Rng rng(3, trial, "outliers");
    for (std::size_t i = 0; outliers && i < points.size(); i += 5)
      points[i] += (0.12 + 2.0 * rng.uniform()) * kView.normalized();
    return points;
  }
};

// sum w min(|d|, cut)^2 over all points, their closest points found from nothing.
double objective_mm2(const RegistrationProblem& problem, const WorkingScan& scan, bool exact,
                     const RigidTransform& part_from_mcs, double cut_mm) {
  CorrespondenceFinder finder(problem.target, problem.options, scan.position_mcs_mm, exact);
  Correspondences c;
  finder.find(part_from_mcs, {}, c);
  double sum = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i)
    sum += scan.weight[i] * std::min(c.distance_mm[i] * c.distance_mm[i], cut_mm * cut_mm);
  return sum;
}

// Returns the number of steps judged. Every pose of the trace is held against the one before, at the cut of
// the one before.
std::size_t expect_descent(const RegistrationProblem& problem, const WorkingScan& scan, bool exact,
                           const std::vector<IterationTrace>& trace, std::size_t first) {
  const double rounding_mm2 = problem.floor_mm * problem.floor_mm * static_cast<double>(scan.size());
  for (std::size_t k = first; k + 1 < trace.size(); ++k) {
    const double before = objective_mm2(problem, scan, exact, trace[k].part_from_mcs, trace[k].cut_mm);
    const double after = objective_mm2(problem, scan, exact, trace[k + 1].part_from_mcs, trace[k].cut_mm);
    // The two sums are rounded differently: 3,000 terms, each to 1e-16 of it and its distance to the floor.
    EXPECT_LE(after, before * (1.0 + 1e-11) + 2.0 * rounding_mm2) << "step " << k << " of " << trace.size();
  }
  return trace.size() - first - 1;
}

std::size_t expect_descent(const Part& part, std::size_t count, const Situation& situation) {
  const RegistrationTarget target(part);
  const RegistrationOptions options = preset("default");
  const std::vector<Vec3> points = situation.points(part, count);
  const RigidTransform truth = shapes::some_pose();
  const WorkingScan scan = prepare_scan(shapes::seen_from(truth, points), options.weights);
  RegistrationState state;
  state.part_from_mcs = shapes::displaced(truth, situation.away, situation.away * kDegree,
                                          shapes::centroid_of(points), 2, situation.trial);
  // 64 ulps of the largest coordinate, some 200 mm, as register_scan has it.
  const double floor_mm = 64.0 * std::numeric_limits<double>::epsilon() * 200.0;
  const RegistrationProblem problem{target, options, LockedMotion(options.lock, state.part_from_mcs),
                                    extent_of(scan), floor_mm};
  iterate(problem, scan, IterationGoal::near_the_minimum, false, state);
  std::size_t judged = expect_descent(problem, scan, false, state.trace, 0);
  const std::size_t first = state.trace.size();
  const bool exact = part.exact != nullptr;
  iterate(problem, scan, IterationGoal::termination, exact, state);
  return judged + expect_descent(problem, scan, exact, state.trace, first);
}

class Descent : public testing::TestWithParam<int> {};

TEST_P(Descent, OfTheDefaultIsNeverInterrupted) {
  const int which = GetParam();
  FacetingOptions faceting;
  faceting.chord_tolerance_mm = 0.02;
  const Part part = which == 0   ? shapes::blade(48, 44)
                    : which == 1 ? shapes::torus(20, 7, 60, 30)
                    : which == 2 ? shapes::box(Vec3(30, 20, 10), 3)
                                 : make_turbine_blade(TurbineBladeParameters{}, faceting);
  std::size_t judged = 0;
  for (const double sigma_mm : {0.0, 0.01})
    for (const bool outliers : {false, true})
      for (const double away : {0.2, 3.0, 10.0})
        for (std::uint64_t trial = 0; trial < 10; ++trial) {
          SCOPED_TRACE(testing::Message() << "sigma " << sigma_mm << ", outliers " << outliers << ", " << away
                                          << " mm and degrees, trial " << trial);
          judged += expect_descent(part, 400, {sigma_mm, outliers, away, trial});
        }
  EXPECT_GT(judged, 300U);
}

std::string part_name(const testing::TestParamInfo<int>& info) {
  constexpr const char* kNames[] = {"Blade", "Torus", "Box", "CadBlade"};
  return kNames[info.param];
}
INSTANTIATE_TEST_SUITE_P(Parts, Descent, testing::Range(0, 4), part_name);

}  // namespace
}  // namespace trueblade
