// The simulated backend: without errors it measures exactly; its noise has the stated moments; a sample does
// not depend on threads or on how the scan is cut into lines; a misplaced part falls out of range; the
// driver's contract holds.
#include "sim/simulated_machine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>

#include "geometry/error.h"
#include "hardware/execute_plan.h"
#include "hardware/plan_view.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;

struct Scene {
  explicit Scene(Part made)
      : part(std::make_shared<Part>(std::move(made))), caster(std::make_shared<RayCaster>(part->model)) {
    setup.lens = standard_lens("25mm");
    setup.geometry.stage_from_probe_at_zero.translation_mm = {0.0, 50.0, 0.0};
  }
  SimulatedMachine machine() const { return SimulatedMachine(make_virtual_part(part, caster), setup); }
  ScanPlan plan(const PlanOptions& options) const {
    return plan_view(setup.geometry, setup.lens, *part, *caster, setup.part_from_mcs, options);
  }

  std::shared_ptr<Part> part;
  std::shared_ptr<RayCaster> caster;
  VirtualSetup setup;
};

TEST(SimulatedMachine, WithoutErrorsEveryPointLiesOnThePart) {
  Scene scene(testing::sphere(12.0));
  scene.setup.sensor = perfect_sensor();
  scene.setup.geometry.rotary_axis_point_mm = {5.0, 3.0, 0.0};
  scene.setup.part_from_mcs.rotation = rotation_from_vector({0.3, 0.2, 0.1});
  scene.setup.part_from_mcs.translation_mm = {2.0, -3.0, 4.0};
  scene.setup.mcs_from_fixture.translation_mm = {20.0, 30.0, -40.0};
  SimulatedMachine machine = scene.machine();
  for (const double theta : {0.0, 1.0, -2.5}) {
    PlanOptions options;
    options.theta_rad = theta;
    options.spacing_mm = 0.8;
    const ViewScan scan = execute_plan(machine, scene.setup.geometry, scene.plan(options));
    const SimulationTruth truth = machine.take_truth();
    ASSERT_EQ(truth.hits.size(), scan.samples.size());
    ASSERT_EQ(scan.usable.size(), scan.samples.size());
    ASSERT_GT(scan.points.size(), 500u);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Vec3 measured_pcs = scene.setup.part_from_mcs * scan.points.position_mcs_mm[i];
      const TrueHit& hit = *truth.hits[scan.usable[i]];
      EXPECT_LT((measured_pcs - hit.point_pcs_mm).norm(), 1e-9);
      const Vec3 normal = scene.part->model.facet_normal(hit.facet);
      EXPECT_NEAR(normal.dot(measured_pcs - scene.part->model.corners_mm(hit.facet)[0]), 0.0, 1e-9);
    }
  }
}

TEST(SimulatedMachine, TheTruePoseTakesMeasuredPointsOntoThePart) {
  Scene scene(testing::sphere(12.0));
  scene.setup.lens = standard_lens("100mm");
  scene.setup.sensor = perfect_sensor();
  for (const ErrorSource source : {ErrorSource::part_x, ErrorSource::part_y, ErrorSource::fixture_z})
    scene.setup.errors[source] = {0.1, 0.2, ErrorScope::setup};
  for (const ErrorSource source : {ErrorSource::part_a, ErrorSource::part_c, ErrorSource::fixture_b})
    scene.setup.errors[source] = {0.0, 0.02, ErrorScope::setup};
  SimulatedMachine machine = scene.machine();
  const ViewScan scan = execute_plan(machine, scene.setup.geometry, scene.plan({}));
  const SimulationTruth truth = machine.take_truth();
  EXPECT_GT(rotation_angle_between(truth.part_from_mcs, scene.setup.part_from_mcs), 1e-3);
  ASSERT_GT(scan.points.size(), 100u);
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    EXPECT_LT(
        (truth.part_from_mcs * scan.points.position_mcs_mm[i] - truth.hits[scan.usable[i]]->point_pcs_mm)
            .norm(),
        1e-9);
}

// A part that rattles in its fixture, for every line or point anew: the true pose is its mean place, and the
// measured points scatter about it.
TEST(SimulatedMachine, ThePoseOfARattlingPartIsItsMean) {
  constexpr double kSigmaMm = 0.01;
  for (const ErrorScope scope : {ErrorScope::line, ErrorScope::point}) {
    Scene scene(testing::plate(0.0, 19.9));
    scene.setup.sensor = perfect_sensor();
    scene.setup.errors[ErrorSource::part_y] = {0.05, kSigmaMm, scope};
    scene.setup.errors[ErrorSource::fixture_y] = {0.0, 0.02, ErrorScope::setup};
    SimulatedMachine machine = scene.machine();
    PlanOptions options;
    options.spacing_mm = 0.2;
    const ViewScan scan = execute_plan(machine, scene.setup.geometry, scene.plan(options));
    const SimulationTruth truth = machine.take_truth();
    ASSERT_EQ(scan.points.size(), 100u * 100u);
    double sum = 0.0;  // of the distances from the plate at its true pose
    for (const Vec3& p : scan.points.position_mcs_mm) sum += (truth.part_from_mcs * p).y();
    const double draws = scope == ErrorScope::line ? 100.0 : 10'000.0;
    EXPECT_NEAR(sum / 1e4, 0.0, 4.0 * kSigmaMm / std::sqrt(draws));
    EXPECT_NE(truth.part_from_mcs.translation_mm.y(), -0.05);  // the set-up's draw is in it
  }
}

TEST(SimulatedMachine, DistanceNoiseHasTheLenssSigma) {
  Scene scene(testing::plate(0.0, 19.9));
  scene.setup.sensor.speckle = 0.0;  // plain Gaussian
  SimulatedMachine machine = scene.machine();
  PlanOptions options;
  options.spacing_mm = 0.2;
  const ViewScan scan = execute_plan(machine, scene.setup.geometry, scene.plan(options));
  const auto n = static_cast<double>(scan.points.size());
  ASSERT_EQ(scan.points.size(), 100u * 100u);
  double sum = 0.0, sum_of_squares = 0.0;
  for (const Vec3& p : scan.points.position_mcs_mm) {
    sum += p.y();
    sum_of_squares += p.y() * p.y();
  }
  const double sigma_mm = 0.003;
  EXPECT_NEAR(sum / n, 0.0, 4.0 * sigma_mm / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(sum_of_squares / n), sigma_mm, 4.0 * sigma_mm / std::sqrt(2.0 * n));
}

bool same_distances(const ViewScan& a, const ViewScan& b) {
  if (a.samples.size() != b.samples.size()) return false;
  for (std::size_t i = 0; i < a.samples.size(); ++i)
    if (a.samples[i].distance_mm != b.samples[i].distance_mm || a.samples[i].snr != b.samples[i].snr)
      return false;
  return true;
}

Scene noisy_scene() {
  Scene scene(testing::sphere(12.0));
  scene.setup.seed = 42;
  scene.setup.errors[ErrorSource::part_y] = {0.0, 0.05, ErrorScope::setup};
  scene.setup.errors[ErrorSource::eyy] = {0.0, 0.002, ErrorScope::point};
  scene.setup.errors[ErrorSource::ecc] = {0.0, 1e-5, ErrorScope::point};
  return scene;
}

TEST(SimulatedMachine, ResultsAreTheSameBitsOnAnyNumberOfThreads) {
  const Scene scene = noisy_scene();
  PlanOptions options;
  options.spacing_mm = 0.3;
  const ScanPlan plan = scene.plan(options);
  std::vector<ViewScan> scans;
  for (const std::size_t threads : {1u, 4u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    SimulatedMachine machine = scene.machine();
    scans.push_back(execute_plan(machine, scene.setup.geometry, plan));
  }
  EXPECT_TRUE(same_distances(scans[0], scans[1]));
}

TEST(SimulatedMachine, ASampleDoesNotDependOnHowTheScanIsCutIntoLines) {
  const Scene scene = noisy_scene();
  const ScanPlan plan = scene.plan({});
  ScanPlan cut = plan;
  cut.lines.clear();
  for (const PlannedLine& line : plan.lines)
    for (const AxisPositions& axes : line.path) cut.lines.push_back({{}, {axes}});
  SimulatedMachine one = scene.machine(), other = scene.machine();
  EXPECT_TRUE(same_distances(execute_plan(one, scene.setup.geometry, plan),
                             execute_plan(other, scene.setup.geometry, cut)));
}

TEST(SimulatedMachine, SeedsAndTrialsDiffer) {
  Scene scene = noisy_scene();
  const ScanPlan plan = scene.plan({});
  const auto scan_with = [&](std::uint64_t seed, std::uint64_t trial) {
    scene.setup.seed = seed;
    scene.setup.trial = trial;
    SimulatedMachine machine = scene.machine();
    return execute_plan(machine, scene.setup.geometry, plan);
  };
  const ViewScan first = scan_with(1, 0);
  EXPECT_TRUE(same_distances(first, scan_with(1, 0)));
  EXPECT_FALSE(same_distances(first, scan_with(2, 0)));
  EXPECT_FALSE(same_distances(first, scan_with(1, 1)));
}

TEST(SimulatedMachine, AMisplacedPlateFallsOutOfRangeAsAWhole) {
  for (const double shift_mm : {-0.36, -0.34, 0.34, 0.36}) {
    Scene scene(testing::plate(0.0, 10.0));
    const ScanPlan plan = scene.plan({});
    scene.setup.errors[ErrorSource::part_y].mean = shift_mm;  // along the beam; half the range is 0.35 mm
    SimulatedMachine machine = scene.machine();
    const ViewScan scan = execute_plan(machine, scene.setup.geometry, plan);
    EXPECT_EQ(scan.usable.size(), std::abs(shift_mm) < 0.35 ? scan.samples.size() : 0u);
    for (const ProbeSample& sample : scan.samples)
      EXPECT_EQ(sample.flags.out_of_range, std::abs(shift_mm) > 0.35);
  }
}

TEST(SimulatedMachine, ATiltedPlateFallsOutOfRangeAtItsEnds) {
  Scene scene(testing::plate(0.0, 20.01));
  PlanOptions options;
  options.spacing_mm = 0.4;  // 51 columns at -10 ... 10
  const ScanPlan plan = scene.plan(options);
  scene.setup.errors[ErrorSource::part_c].mean = 0.05;  // about z: the plate is x tan(0.05) off at x
  SimulatedMachine machine = scene.machine();
  const ViewScan scan = execute_plan(machine, scene.setup.geometry, plan);
  // In range where |x| tan(0.05) < 0.35, |x| < 6.994: columns at -6.8 ... 6.8, 35 of 51, in all 51 rows. The
  // tilted plate spans |x| < 10.005 cos(0.05) = 9.9925, so that the outermost columns miss it.
  std::size_t missed = 0;
  for (const ProbeSample& sample : scan.samples) missed += sample.flags.missed ? 1 : 0;
  EXPECT_EQ(scan.usable.size(), 35u * 51u);
  EXPECT_EQ(missed, 2u * 51u);
}

TEST(SimulatedMachine, SamplesTakenLateAreShiftedByVelocityTimesDelay) {
  Scene scene(testing::plate(0.0, 20.0));
  scene.setup.sensor = perfect_sensor();
  scene.setup.errors[ErrorSource::time_base].mean = 0.001;
  SimulatedMachine machine = scene.machine();
  machine.connect();
  machine.home();
  const double y_mm = -25.0;  // the mount adds 50: standoff of the plate at y = 0
  machine.move_to({0.0, y_mm, 0.0, 0.0});
  // At 500 mm/s^2 and 50 mm/s: ramps of 2.5 mm at both ends.
  std::vector<AxisPositions> path;
  for (int k = 1; k <= 9; ++k) path.push_back({static_cast<double>(k), y_mm, 0, 0});
  machine.scan_line(path, [](const ProbeSample&) { return true; });
  const SimulationTruth truth = machine.take_truth();
  for (std::size_t k = 0; k < path.size(); ++k)
    EXPECT_NEAR(truth.hits[k]->point_pcs_mm.x(),
                path[k].x_mm + 0.001 * std::min(50.0, std::sqrt(2.0 * 500.0 *
                                                                std::min(path[k].x_mm, 9.0 - path[k].x_mm))),
                1e-9);
}

TEST(SimulatedMachine, TheClockKeepsToThePlansEstimate) {
  const Scene scene = noisy_scene();
  const ScanPlan plan = scene.plan({});
  SimulatedMachine machine = scene.machine();
  const ViewScan scan = execute_plan(machine, scene.setup.geometry, plan);
  const double retreat_s =
      move_time_s(scene.setup.dynamics, plan.lines.back().path.back(), plan.retreat.front());
  const double estimate_s = estimated_time_s(plan, scene.setup.dynamics, scene.setup.lens, {});
  ASSERT_EQ(plan.retreat.size(), 1u);
  EXPECT_NEAR(scan.samples.back().time_s, estimate_s - retreat_s, 1e-9);
}

TEST(SimulatedMachine, NothingMovesBeforeConnectingAndHoming) {
  const Scene scene(testing::plate(0.0, 10.0));
  SimulatedMachine machine = scene.machine();
  const auto kind_of = [](auto&& action) {
    try {
      action();
    } catch (const MachineFault& fault) {
      return fault.kind();
    }
    throw std::logic_error("no fault");
  };
  const auto ignore = [](const ProbeSample&) { return true; };
  const std::vector<AxisPositions> path(2);
  EXPECT_EQ(machine.state(), MachineState::disconnected);
  EXPECT_EQ(kind_of([&] { machine.home(); }), MachineFault::Kind::connection);
  EXPECT_EQ(kind_of([&] { machine.move_to({}); }), MachineFault::Kind::connection);
  machine.connect();
  EXPECT_EQ(machine.state(), MachineState::not_homed);
  EXPECT_EQ(kind_of([&] { machine.move_to({}); }), MachineFault::Kind::not_homed);
  EXPECT_EQ(kind_of([&] { machine.measure_point(); }), MachineFault::Kind::not_homed);
  EXPECT_EQ(kind_of([&] { machine.scan_line(path, ignore); }), MachineFault::Kind::not_homed);
  machine.home();
  EXPECT_EQ(machine.state(), MachineState::idle);
  EXPECT_EQ(kind_of([&] { machine.move_to({501.0, 0.0, 0.0, 0.0}); }), MachineFault::Kind::limit);
  const std::vector<AxisPositions> beyond{{}, {0.0, 0.0, std::nan(""), 0.0}};
  EXPECT_EQ(kind_of([&] { machine.scan_line(beyond, ignore); }), MachineFault::Kind::limit);
  EXPECT_TRUE(machine.take_truth().hits.empty());  // the line was refused as a whole
}

TEST(SimulatedMachine, StopEndsALineAndHoldsUntilHomed) {
  const Scene scene(testing::plate(0.0, 10.0));
  SimulatedMachine machine = scene.machine();
  machine.connect();
  machine.home();
  const std::vector<AxisPositions> path(100);
  std::size_t received = 0;
  EXPECT_THROW(machine.scan_line(path,
                                 [&](const ProbeSample&) {
                                   if (++received == 7) machine.stop();
                                   return true;
                                 }),
               MachineFault);
  EXPECT_EQ(received, 7u);
  EXPECT_EQ(machine.state(), MachineState::stopped);
  EXPECT_THROW(machine.move_to({}), MachineFault);
  machine.home();
  EXPECT_NO_THROW(machine.move_to({}));
}

TEST(SimulatedMachine, ARefusingSinkEndsTheLineAfterItsSample) {
  const Scene scene(testing::plate(0.0, 10.0));
  SimulatedMachine machine = scene.machine();
  machine.connect();
  machine.home();
  const std::vector<AxisPositions> path(10);
  std::size_t received = 0;
  EXPECT_EQ(machine.scan_line(path, [&](const ProbeSample&) { return ++received < 4; }), 4u);
  EXPECT_EQ(machine.take_truth().hits.size(), 4u);
}

TEST(SimulatedMachine, ImpossibleSetupsAreRefused) {
  Scene scene(testing::plate(0.0, 10.0));
  scene.setup.limits.lower.x_mm = 1.0;  // home is outside
  EXPECT_THROW(scene.machine(), InputError);
  Scene lens(testing::plate(0.0, 10.0));
  lens.setup.lens.standoff_mm = -1.0;
  EXPECT_THROW(lens.machine(), InputError);
}

}  // namespace
}  // namespace trueblade
