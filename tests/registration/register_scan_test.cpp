// The registration as a whole: it finds the pose, says what it did, and does not depend on what must not
// matter (origin, order of the points, threads).
#include "registration/register_scan.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kDegree = shapes::kPi / 180.0;

struct Case {
  Part part;
  RigidTransform truth = shapes::some_pose();
  std::vector<Vec3> points;
  ScanPoints scan;
  Vec3 centroid_mcs_mm;

  Case(Part p, std::size_t count, const Vec3& view, double sigma_mm) : part(std::move(p)) {
    points = shapes::points_on(part, count, view, sigma_mm, 1);
    scan = shapes::seen_from(truth, points);
    centroid_mcs_mm = shapes::centroid_of(scan.position_mcs_mm);
  }
  RigidTransform start(double distance_mm, double angle_rad, std::uint64_t trial = 0) const {
    return shapes::displaced(truth, distance_mm, angle_rad, truth * centroid_mcs_mm, 2, trial);
  }
};

TEST(RegisterScan, NoiseFreeScanOnFacetsReturnsToTheTruePose) {
  const Case c(shapes::blade(96, 88), 3400, Vec3(0.3, 1.0, 0.4), 0.0);
  const RegistrationTarget target(c.part);
  for (std::uint64_t trial = 0; trial < 4; ++trial) {
    const auto result = register_scan(target, c.scan, c.start(3.0, 3.0 * kDegree, trial), preset("default"));
    EXPECT_TRUE(is_converged(result.termination)) << full_report(result);
    const auto error = shapes::pose_error(result.part_from_mcs, c.truth, c.centroid_mcs_mm);
    EXPECT_LT(error.centroid_mm, 1e-7) << full_report(result);
    EXPECT_LT(error.rotation_rad, 1e-9);
    EXPECT_EQ(result.undetermined.size(), 0U);
  }
}

// From here one iteration alone ends in a minimum where the airfoil fits and the platform does not, for about
// a fifth of the starts.
TEST(RegisterScan, LeavesAMinimumWhereOnlyAPartOfTheScanFits) {
  const Case c(shapes::blade(48, 44), 1500, Vec3(0.3, 1.0, 0.4), 0.003);
  const RegistrationTarget target(c.part);
  RegistrationOptions one_start = preset("default");
  one_start.sampling.points = 0;
  int found = 0, found_by_one = 0;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    const RigidTransform start = c.start(5.0, 5.0 * kDegree, trial);
    const auto error_mm = [&](const RegistrationOptions& options) {
      const auto result = register_scan(target, c.scan, start, options);
      return shapes::pose_error(result.part_from_mcs, c.truth, c.centroid_mcs_mm).centroid_mm;
    };
    found += error_mm(preset("default")) < 0.02;
    found_by_one += error_mm(one_start) < 0.02;
  }
  EXPECT_EQ(found, 20);
  EXPECT_LT(found_by_one, 20);
}

TEST(RegisterScan, TellsAMisfitFromNoise) {
  const Case c(shapes::blade(48, 44), 1500, Vec3(0.3, 1.0, 0.4), 0.003);
  const RegistrationTarget target(c.part);
  EXPECT_FALSE(register_scan(target, c.scan, c.start(0.2, 0.2 * kDegree), preset("default")).shows_misfit);
  // Bent by 0.1 mm over its length: much more than the noise, and smooth.
  ScanPoints bent = c.scan;
  for (std::size_t i = 0; i < bent.size(); ++i) {
    Vec3 point = c.truth * bent.position_mcs_mm[i];
    point.y() += 0.1 * std::sin(point.z() / 10.0);
    bent.position_mcs_mm[i] = c.truth.inverse() * point;
  }
  EXPECT_TRUE(register_scan(target, bent, c.start(0.2, 0.2 * kDegree), preset("default")).shows_misfit);
  const Case noise_free(shapes::blade(48, 44), 1500, Vec3(0.3, 1.0, 0.4), 0.0);
  const RegistrationTarget its_target(noise_free.part);
  EXPECT_FALSE(
      register_scan(its_target, noise_free.scan, noise_free.start(0.2, 0.2 * kDegree), preset("default"))
          .shows_misfit);
}

TEST(RegisterScan, PublishedClosedFormConvergesToTheSamePoseAsPointToPlane) {
  const Case c(shapes::blade(48, 44), 1500, Vec3(0.3, 1.0, 0.4), 0.003);
  const RegistrationTarget target(c.part);
  RegistrationOptions closed = preset("default");
  closed.step.method = StepMethod::unit_quaternion;
  closed.termination.statistical_step = 0.0;
  closed.termination.step_mm = 1e-9;
  closed.termination.maximum_iterations = 20000;
  closed.rejection.rule = RejectionRule::none;
  RegistrationOptions plane = preset("default");
  plane.rejection.rule = RejectionRule::none;
  plane.termination.statistical_step = 1e-6;
  const auto a = register_scan(target, c.scan, c.start(0.1, 0.1 * kDegree), closed);
  const auto b = register_scan(target, c.scan, c.start(0.1, 0.1 * kDegree), plane);
  const auto difference = shapes::pose_error(a.part_from_mcs, b.part_from_mcs, c.centroid_mcs_mm);
  // Both minimise the same sum of squared distances; the closed form converges linearly and stops at steps of
  // 1e-9 mm, a thousand of them from the minimum at a rate of 0.999.
  EXPECT_LT(difference.centroid_mm, 1e-5) << full_report(a) << full_report(b);
}

const Vec3 kFront(0.3, 1.0, 0.4);
// The blade reaches this far from its middle across its length: a distance tells a rotation at least so well.
constexpr double kLeastReach_mm = 10.0;

std::string complaint(const RegistrationTarget& target, const ScanPoints& scan, const RigidTransform& initial,
                      const RegistrationOptions& options) {
  try {
    register_scan(target, scan, initial, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RegisterScan, TwentyPercentGrossOutliersAreFoundAndTheRestKept) {
  Case c(shapes::blade(48, 44), 2000, kFront, 0.003);
  Rng rng(3, 0, "outliers");
  for (std::size_t i = 0; i < c.points.size(); i += 5) {
    // At least 40 sigma from the surface, to one side mostly, so that a plain fit is pulled away.
    const double away = 0.12 + 2.0 * rng.uniform();
    c.scan.position_mcs_mm[i] = c.truth.inverse() * Vec3(c.points[i] + away * kFront.normalized());
  }
  const RegistrationTarget target(c.part);
  const auto result = register_scan(target, c.scan, c.start(1.0, kDegree), preset("default"));
  EXPECT_TRUE(is_converged(result.termination));
  const auto error = shapes::pose_error(result.part_from_mcs, c.truth, c.centroid_mcs_mm);
  EXPECT_LT(error.centroid_mm, 0.002) << full_report(result);  // about six standard uncertainties
  std::size_t good_kept = 0, bad_kept = 0;
  for (std::size_t i = 0; i < c.points.size(); ++i) (i % 5 ? good_kept : bad_kept) += result.is_inlier[i];
  EXPECT_GT(good_kept, 1590U);  // of 1,600; 4 sigma of a scale that is at most 1.3 sigma
  EXPECT_LT(bad_kept, 40U);     // a point lifted along the view may still lie near another facet
  EXPECT_EQ(result.inliers, good_kept + bad_kept);
  EXPECT_EQ(result.inliers + result.outliers, c.scan.size());
  EXPECT_NEAR(result.sigma_mm, 0.003, 0.0003);
}

// A stage that stops a micrometre wrong in every line: along the flat sides of the blade that is next to
// nothing, at its edges all of it. No normal distribution has such residuals, and what a cut leaves of them
// has another scale than the one that the cut came from.
TEST(RegisterScan, ResidualsFarFromNormalConverge) {
  const Case noise_free(shapes::blade(96, 88), 3000, Vec3::Zero(), 0.0);
  const RegistrationTarget target(noise_free.part);
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    const Rng stops(11, trial, "stops of the lines");
    ScanPoints scan = noise_free.scan;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const auto line = static_cast<std::uint64_t>(noise_free.points[i].z() + 1.0);
      const Vec3 wrong_mm(0.001 * stops.at(line).normal(), 0.0, 0.0);
      scan.position_mcs_mm[i] = noise_free.truth.inverse() * (noise_free.points[i] + wrong_mm);
    }
    const auto result =
        register_scan(target, scan, noise_free.start(0.1, 0.1 * kDegree, trial), preset("default"));
    EXPECT_TRUE(is_converged(result.termination)) << full_report(result);
  }
}

TEST(RegisterScan, ObjectiveNeverRisesFromStepToStep) {
  const Case c(shapes::blade(48, 44), 1500, kFront, 0.01);
  const RegistrationTarget target(c.part);
  for (std::uint64_t trial = 0; trial < 8; ++trial) {
    RegistrationOptions options = preset("default");
    options.rejection.rule = RejectionRule::none;
    options.sampling.points = 0;  // the same points from step to step
    const auto result = register_scan(target, c.scan, c.start(10.0, 10.0 * kDegree, trial), options);
    ASSERT_GT(result.trace.size(), 1U);
    // Without rejection the objective is the mean square itself.
    for (std::size_t k = 1; k < result.trace.size(); ++k)
      EXPECT_LE(result.trace[k].weighted_rms_mm, result.trace[k - 1].weighted_rms_mm * (1.0 + 1e-9)) << k;
  }
}

TEST(RegisterScan, HasTheSameBitsOnAnyNumberOfThreads) {
  const Case c(shapes::blade(48, 44), 9000, kFront, 0.003);
  const RegistrationTarget target(c.part);
  for (const std::string_view name : {"default", "zhu2007"}) {
    RegistrationResult one, many;
    tbb::task_arena(1).execute(
        [&] { one = register_scan(target, c.scan, c.start(1.0, kDegree), preset(name)); });
    tbb::task_arena(4).execute(
        [&] { many = register_scan(target, c.scan, c.start(1.0, kDegree), preset(name)); });
    EXPECT_EQ(one.part_from_mcs.rotation.coeffs(), many.part_from_mcs.rotation.coeffs()) << name;
    EXPECT_EQ(one.part_from_mcs.translation_mm, many.part_from_mcs.translation_mm) << name;
    EXPECT_EQ(one.covariance, many.covariance) << name;
    EXPECT_EQ(one.is_inlier, many.is_inlier) << name;
    EXPECT_EQ(one.iterations, many.iterations) << name;
  }
}

// Two paths to one minimum: each stops within 0.02 of the pose's standard uncertainty, 1e-4 mm here.
TEST(RegisterScan, DoesNotDependOnTheOrderOfThePoints) {
  const Case c(shapes::blade(48, 44), 2000, kFront, 0.003);
  const RegistrationTarget target(c.part);
  const auto a = register_scan(target, c.scan, c.start(1.0, kDegree), preset("default"));
  for (std::uint64_t trial = 0; trial < 5; ++trial) {
    std::vector<std::size_t> order(c.scan.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    Rng rng(9, trial, "order of the points");
    for (std::size_t i = order.size(); i-- > 1;)
      std::swap(order[i], order[static_cast<std::size_t>(rng.uniform() * static_cast<double>(i + 1))]);
    ScanPoints shuffled;
    for (const std::size_t i : order) shuffled.position_mcs_mm.push_back(c.scan.position_mcs_mm[i]);
    const auto b = register_scan(target, shuffled, c.start(1.0, kDegree), preset("default"));
    const auto difference = shapes::pose_error(a.part_from_mcs, b.part_from_mcs, c.centroid_mcs_mm);
    EXPECT_LT(difference.centroid_mm, 1e-9);
    EXPECT_LT(difference.rotation_rad, 1e-10);
    for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(b.is_inlier[k], a.is_inlier[order[k]]);
  }
}

TEST(RegisterScan, DoesNotDependOnTheScansOriginTenMetresAway) {
  const Case c(shapes::blade(48, 44), 2000, kFront, 0.003);
  const RegistrationTarget target(c.part);
  const Vec3 far(10000.0, -7000.0, 4000.0);
  ScanPoints moved = c.scan;
  for (Vec3& p : moved.position_mcs_mm) p += far;
  RigidTransform mcs_from_moved;
  mcs_from_moved.translation_mm = -far;
  const RigidTransform start = c.start(1.0, kDegree);
  // zhu2007 is left out: its walk and its cut choose by comparisons that rounding may turn over.
  const auto a = register_scan(target, c.scan, start, preset("default"));
  const auto b = register_scan(target, moved, start * mcs_from_moved, preset("default"));
  const auto difference =
      shapes::pose_error(a.part_from_mcs * mcs_from_moved, b.part_from_mcs, far + c.centroid_mcs_mm);
  const double rounding_mm = shapes::rounding_of_the_centroid_mm(a, far.norm());
  EXPECT_LT(difference.centroid_mm, rounding_mm);
  EXPECT_LT(difference.rotation_rad, rounding_mm / kLeastReach_mm);
}

TEST(RegisterScan, DoesNotDependOnThePartsOriginTenMetresAway) {
  const Case c(shapes::blade(48, 44), 2000, kFront, 0.003);
  RigidTransform moved_from_part;
  moved_from_part.translation_mm = Vec3(-8000.0, 3000.0, 5000.0);
  FacetSoup soup = shapes::blade_soup(48, 44);
  for (Vec3& node : soup.nodes_mm) node = moved_from_part * node;
  const Part moved_part = shapes::part_of(soup);
  const RigidTransform start = c.start(1.0, kDegree);
  const auto a = register_scan(RegistrationTarget(c.part), c.scan, start, preset("default"));
  const auto b =
      register_scan(RegistrationTarget(moved_part), c.scan, moved_from_part * start, preset("default"));
  const auto difference =
      shapes::pose_error(b.part_from_mcs, moved_from_part * a.part_from_mcs, c.centroid_mcs_mm);
  const double rounding_mm = shapes::rounding_of_the_centroid_mm(a, moved_from_part.translation_mm.norm());
  EXPECT_LT(difference.centroid_mm, rounding_mm);
  EXPECT_LT(difference.rotation_rad, rounding_mm / kLeastReach_mm);
  EXPECT_EQ(b.is_inlier, a.is_inlier);
}

TEST(RegisterScan, RandomRigidMotionsOfTheScanAreUndone) {
  const Part part = shapes::blade(48, 44);
  const RegistrationTarget target(part);
  const auto points = shapes::points_on(part, 800, kFront, 0.0, 1);
  for (std::uint64_t trial = 0; trial < 10; ++trial) {
    Rng rng(9, trial, "motions");
    RigidTransform truth;
    truth.rotation = rotation_from_vector(3.0 * rng.uniform() * rng.normal_vector().normalized());
    truth.translation_mm = 500.0 * rng.normal_vector();
    const ScanPoints scan = shapes::seen_from(truth, points);
    const RigidTransform start =
        shapes::displaced(truth, 0.5, 0.5 * kDegree, shapes::centroid_of(points), 5, trial);
    const auto result = register_scan(target, scan, start, preset("default"));
    const auto error =
        shapes::pose_error(result.part_from_mcs, truth, shapes::centroid_of(scan.position_mcs_mm));
    EXPECT_LT(error.centroid_mm, 1e-7) << full_report(result);
    EXPECT_LT(error.rotation_rad, 1e-9);
  }
}

TEST(RegisterScan, AlignsOnSelectedSurfacesAlone) {
  // The platform stands 0.5 mm off its nominal place against the airfoil.
  const Part part = shapes::blade(48, 44);
  auto points = shapes::points_on(part, 3000, kFront, 0.0, 1);
  const ClosestPointTree tree(part.model);
  for (Vec3& p : points)
    if (part.model.surface_of(tree.query(p).facet) >= 2) p += Vec3(0.5, 0.0, 0.3);
  const RigidTransform truth = shapes::some_pose();
  const ScanPoints scan = shapes::seen_from(truth, points);
  const RegistrationTarget target(part);
  RegistrationOptions options = preset("default");
  options.surfaces = {0, 1};
  const RigidTransform start = shapes::displaced(truth, 0.1, 0.1 * kDegree, shapes::centroid_of(points), 5);
  const auto airfoil = register_scan(target, scan, start, options);
  const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
  // A few points near the root change sides between platform and airfoil; the cut removes those.
  EXPECT_LT(shapes::pose_error(airfoil.part_from_mcs, truth, centroid_mcs).centroid_mm, 0.01)
      << full_report(airfoil);
  options.surfaces.clear();
  options.rejection.rule = RejectionRule::none;
  const auto all = register_scan(target, scan, start, options);
  EXPECT_GT(shapes::pose_error(all.part_from_mcs, truth, centroid_mcs).centroid_mm, 0.05);
}

TEST(RegisterScan, LockedFreedomsDoNotMoveAndTheRestIsTheirOptimum) {
  const Case c(shapes::blade(48, 44), 1500, kFront, 0.003);
  const RegistrationTarget target(c.part);
  const RigidTransform start = c.start(0.2, 0.2 * kDegree);
  RegistrationOptions options = preset("default");
  options.rejection.rule = RejectionRule::none;
  options.termination.statistical_step = 1e-5;
  options.lock.freedoms = {Freedom::rotation_y, Freedom::translation_z};
  options.lock.part_from_frame.rotation = rotation_from_vector(Vec3(0.1, 0.2, 0.3));
  options.lock.part_from_frame.translation_mm = Vec3(0, 0, 50);
  const auto locked = register_scan(target, c.scan, start, options);
  EXPECT_TRUE(is_converged(locked.termination)) << full_report(locked);
  const RigidTransform motion = options.lock.part_from_frame.inverse() * locked.part_from_mcs *
                                start.inverse() * options.lock.part_from_frame;
  EXPECT_NEAR(vector_from_rotation(motion.rotation).y(), 0.0, 1e-14);
  EXPECT_NEAR(motion.translation_mm.z(), 0.0, 1e-12);  // rounding of coordinates of 100 mm
  EXPECT_NEAR(locked.covariance.fullPivLu().rank(), 4, 0);

  // Zeroing the locked part of the free solution is worse than the reduced solution.
  options.lock.freedoms.clear();
  const auto free = register_scan(target, c.scan, start, options);
  const RigidTransform frame = options.lock.part_from_frame;
  RigidTransform zeroed = frame.inverse() * free.part_from_mcs * start.inverse() * frame;
  Vec3 rotation = vector_from_rotation(zeroed.rotation);
  rotation.y() = 0.0;
  zeroed.rotation = rotation_from_vector(rotation);
  zeroed.translation_mm.z() = 0.0;
  options.termination.maximum_iterations = 1;
  const auto at_zeroed = register_scan(target, c.scan, frame * zeroed * frame.inverse() * start, options);
  EXPECT_LT(locked.rms_mm, at_zeroed.first_rms_mm * 0.99);
}

TEST(RegisterScan, CrossCheckByCeresAgrees) {
  const Case c(shapes::blade(48, 44), 1500, kFront, 0.003);
  const RegistrationTarget target(c.part);
  RegistrationOptions options = preset("default");
  options.cross_check = true;
  const auto result = register_scan(target, c.scan, c.start(0.5, 0.5 * kDegree), options);
  ASSERT_TRUE(result.cross_check);
  EXPECT_TRUE(result.cross_check->agrees) << result.cross_check->summary;
  EXPECT_LT(result.cross_check->closed_form_rotation_difference_rad, 1e-10);
  EXPECT_LT(result.cross_check->closed_form_difference_mm, 1e-9);

  // With freedoms locked and without rejection, too.
  options.lock.freedoms = {Freedom::rotation_y, Freedom::translation_z};
  options.rejection.rule = RejectionRule::none;
  const auto locked = register_scan(target, c.scan, c.start(0.0, 0.0), options);
  ASSERT_TRUE(locked.cross_check);
  EXPECT_TRUE(locked.cross_check->agrees) << locked.cross_check->summary;
  options.lock.freedoms.clear();

  // A pose that is not the minimum must be found out.
  options.termination.maximum_iterations = 1;
  const auto early = register_scan(target, c.scan, c.start(0.5, 0.5 * kDegree), options);
  ASSERT_TRUE(early.cross_check);
  EXPECT_FALSE(early.cross_check->agrees) << early.cross_check->summary;
}

TEST(RegisterScan, SaysWhyItStopped) {
  const Case c(shapes::blade(48, 44), 800, kFront, 0.003);
  const RegistrationTarget target(c.part);
  const RigidTransform start = c.start(0.5, 0.5 * kDegree);
  RegistrationOptions options = preset("default");
  options.termination = {100, 0.02, 0.0, 0.0};
  EXPECT_EQ(register_scan(target, c.scan, start, options).termination, Termination::converged_statistically);
  options.termination = {100, 0.0, 1e-6, 0.0};
  EXPECT_EQ(register_scan(target, c.scan, start, options).termination, Termination::converged_rms);
  options.termination = {100, 0.0, 0.0, 1e-4};
  EXPECT_EQ(register_scan(target, c.scan, start, options).termination, Termination::converged_step);
  options.termination = {2, 0.02, 0.0, 0.0};
  const auto limited = register_scan(target, c.scan, start, options);
  EXPECT_EQ(limited.termination, Termination::iteration_limit);
  EXPECT_EQ(limited.iterations, 2);
  EXPECT_FALSE(is_converged(limited.termination));
}

TEST(RegisterScan, LowSnrPointsAreDroppedByTheFilter) {
  Case c(shapes::blade(48, 44), 1000, kFront, 0.0);
  c.scan.snr.assign(c.scan.size(), 0.9);
  for (std::size_t i = 0; i < c.scan.size(); i += 4) {
    c.scan.snr[i] = 0.5;
    c.scan.position_mcs_mm[i] += Vec3(0.0, 0.2, 0.0);
  }
  const RegistrationTarget target(c.part);
  RegistrationOptions options = preset("default");
  options.weights.minimum_snr = 0.7;
  options.rejection.rule = RejectionRule::none;
  const auto result = register_scan(target, c.scan, c.start(0.3, 0.3 * kDegree), options);
  EXPECT_LT(shapes::pose_error(result.part_from_mcs, c.truth, c.centroid_mcs_mm).centroid_mm, 1e-7);
  EXPECT_EQ(result.inliers, 750U);
  EXPECT_EQ(result.outliers, 250U);
}

TEST(RegisterScan, ABorderThatTakesEveryPointIsNamed) {
  const Part part = shapes::plane(20, 20, 4);
  ScanPoints beside;
  for (int i = 0; i < 100; ++i) beside.position_mcs_mm.push_back(Vec3(12.0 + 0.01 * i, 0.1 * (i % 7), 0.2));
  RegistrationOptions options = preset("default");
  options.rejection.boundary = BoundaryPolicy::reject;
  try {
    register_scan(RegistrationTarget(part), beside, {}, options);
    FAIL() << "no point is left";
  } catch (const InputError& failure) {
    EXPECT_STREQ(failure.what(),
                 "rejection.boundary reject leaves 0 of 100 points, whose closest points lie off the part's "
                 "border; at least three are needed");
  }
}

TEST(RegisterScan, BadInputNamesWhatIsWrong) {
  const Case c(shapes::blade(24, 22), 200, kFront, 0.0);
  const RegistrationTarget target(c.part);
  const RigidTransform start = c.start(0.1, 0.0);
  const auto with = [&](auto change) {
    ScanPoints scan = c.scan;
    RegistrationOptions options = preset("default");
    change(scan, options);
    return complaint(target, scan, start, options);
  };
  EXPECT_EQ(with([](auto& s, auto&) { s.snr.assign(10, 1.0); }), "the scan has 200 points but 10 SNR values");
  EXPECT_EQ(with([](auto& s, auto&) {
              s.snr.assign(200, 1.0);
              s.snr[7] = 1.5;
            }),
            "SNR of scan point 7 is 1.5, must be within 0 to 1");
  EXPECT_EQ(with([](auto& s, auto&) {
              s.snr.assign(200, 1.0);
              s.snr[7] = std::numeric_limits<double>::quiet_NaN();
            }),
            "SNR of scan point 7 is nan, must be within 0 to 1");
  EXPECT_EQ(with([](auto& s, auto&) {
              s.position_mcs_mm[3] = Vec3(1, std::numeric_limits<double>::infinity(), 2);
            }),
            "scan point 3 is (1, inf, 2), coordinates must be finite");
  EXPECT_EQ(with([](auto& s, auto&) { s.snr.assign(200, 0.0); }),
            "0 of 200 scan points have weight at weights.minimum_snr 0; at least three are needed");
  EXPECT_EQ(with([](auto& s, auto& o) {
              s.snr.clear();
              o.weights.minimum_snr = 0.7;
            }),
            "weights.minimum_snr is 0.7, but the scan has no SNR");
  EXPECT_EQ(with([](auto& s, auto&) { s.position_mcs_mm.clear(); }),
            "the scan has 0 points; at least three are needed");
  EXPECT_EQ(with([](auto& s, auto&) {
              for (std::size_t i = 0; i < s.size(); ++i)
                s.position_mcs_mm[i] = Vec3(0.1, 0.2, 0.3) * static_cast<double>(i);
            }),
            "the scan points lie on one line; at least three non-collinear points are needed");
  EXPECT_EQ(with([](auto& s, auto&) { s.position_mcs_mm.assign(50, Vec3(0.1, 0.2, 0.3)); }),
            "all scan points lie in one place; at least three non-collinear points are needed");
  EXPECT_NE(with([](auto& s, auto&) {
              for (Vec3& p : s.position_mcs_mm) p.x() += 3e6;
            }).find("check the initial pose and the units"),
            std::string::npos);
  EXPECT_EQ(with([](auto&, auto& o) { o.surfaces = {99}; }),
            "surfaces names 99, but the part's surfaces are 0 to 7");
  EXPECT_EQ(with([](auto&, auto& o) { o.surfaces = {7}; }),
            "surfaces [7]: 0 of 200 points are closest to them; at least three are needed");
  RigidTransform bad = start;
  bad.translation_mm.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint(target, c.scan, bad, preset("default")),
            "the initial pose holds a number that is not finite");
}

}  // namespace
}  // namespace trueblade
