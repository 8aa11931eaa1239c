// Execution of a plan through a driver that records what it is told: order of calls, travel check before
// motion, conversion of usable samples, interruption, faults.
#include "hardware/execute_plan.h"

#include <gtest/gtest.h>

#include "geometry/error.h"

namespace trueblade {
namespace {

// Reports the position it was sent to; the distance is 10 mm, and every third sample has no return.
class RecordingDriver : public MachineDriver {
 public:
  std::vector<std::string> calls;
  std::vector<AxisPositions> moves;
  AxisPositions at;
  MachineState present = MachineState::disconnected;
  std::size_t fault_at_sample = SIZE_MAX;
  std::size_t samples = 0;

  void connect() override {
    calls.push_back("connect");
    present = MachineState::not_homed;
  }
  void home() override {
    calls.push_back("home");
    present = MachineState::idle;
  }
  void move_to(const AxisPositions& target) override {
    calls.push_back("move");
    moves.push_back(at = target);
  }
  ProbeSample measure_point() override { return {}; }
  std::size_t scan_line(std::span<const AxisPositions> path, const SampleSink& sink) override {
    calls.push_back("line");
    std::size_t delivered = 0;
    for (const AxisPositions& axes : path) {
      if (samples == fault_at_sample) throw MachineFault(MachineFault::Kind::following_error, "joint 1");
      ProbeSample sample;
      sample.axes = axes;
      sample.distance_mm = 10.0;
      sample.snr = 0.5;
      sample.time_s = 1.0 + 0.5 * static_cast<double>(samples);
      sample.flags.missed = samples % 3 == 2;
      ++samples;
      ++delivered;
      if (!sink(sample)) break;
    }
    return delivered;
  }
  void stop() noexcept override { calls.push_back("stop"); }
  void skip_measured(const MeasuredBefore& before) override {
    calls.push_back("skip " + std::to_string(before.lines) + " " + std::to_string(before.samples));
  }
  MachineState state() const override { return present; }
  AxisPositions position() const override { return at; }
  AxisLimits limits() const override { return {{-50, -50, -50, -7}, {50, 50, 50, 7}}; }
};

ScanPlan two_lines() {
  ScanPlan plan;
  plan.view = "front";
  plan.columns = 3;
  plan.rows = 2;
  plan.lines.resize(2);
  plan.lines[0].path = {{0, 0, 0, 0}, {1, 0, 0, 0}, {2, 0, 0, 0}};
  plan.lines[1].path = {{2, 0, 1, 0}, {1, 0, 1, 0}, {0, 0, 1, 0}};
  plan.grid_index = {0, 1, 2, 5, 4, 3};
  return plan;
}

using Calls = std::vector<std::string>;

TEST(ExecutePlan, ConnectsHomesAndScansLineByLine) {
  RecordingDriver driver;
  const ViewScan scan = execute_plan(driver, {}, two_lines());
  EXPECT_EQ(driver.calls, (Calls{"connect", "home", "move", "line", "move", "line"}));
  EXPECT_TRUE(scan.complete);
  EXPECT_EQ(scan.samples.size(), 6u);
  EXPECT_EQ(scan.usable, (std::vector<std::uint32_t>{0, 1, 3, 4}));
  EXPECT_EQ(scan.grid_index, (std::vector<std::uint32_t>{0, 1, 2, 5, 4, 3}));
  ASSERT_EQ(scan.points.size(), 4u);
  EXPECT_EQ(scan.points.position_mcs_mm[2], Vec3(2.0, -10.0, 1.0));
  EXPECT_EQ(scan.points.snr[2], 0.5);
  EXPECT_EQ(scan.time_s, 2.5);
}

TEST(ExecutePlan, AMachineThatIsReadyIsNotHomedAgain) {
  RecordingDriver driver;
  driver.present = MachineState::idle;
  execute_plan(driver, {}, two_lines());
  EXPECT_EQ(driver.calls.front(), "move");
}

TEST(ExecutePlan, NothingMovesWhenAnyPositionIsOutOfTravel) {
  RecordingDriver driver;
  ScanPlan plan = two_lines();
  plan.lines[1].path[2].z_mm = 50.5;
  try {
    execute_plan(driver, {}, plan);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "view front: planned line 2 leaves the machine's travel: z is 50.500 mm, must be within -50.000 "
        "and 50.000 mm");
  }
  EXPECT_EQ(driver.calls, (Calls{"connect", "home"}));
}

TEST(ExecutePlan, NotANumberIsOutOfTravel) {
  RecordingDriver driver;
  ScanPlan plan = two_lines();
  plan.lines[0].path[0].theta_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(execute_plan(driver, {}, plan), InputError);
}

TEST(ExecutePlan, AnInterruptedScanStopsTheMachineAndKeepsItsSamples) {
  RecordingDriver driver;
  ExecutionOptions options;
  options.progress = [](std::size_t taken, std::size_t planned) {
    EXPECT_EQ(planned, 6u);
    return taken < 4;
  };
  const ViewScan scan = execute_plan(driver, {}, two_lines(), options);
  EXPECT_FALSE(scan.complete);
  EXPECT_EQ(scan.samples.size(), 4u);
  EXPECT_EQ(scan.grid_index.size(), 4u);
  EXPECT_EQ(driver.calls.back(), "stop");
}

TEST(ExecutePlan, AFaultStopsTheMachineAndReachesTheCaller) {
  RecordingDriver driver;
  driver.fault_at_sample = 4;
  try {
    execute_plan(driver, {}, two_lines());
    FAIL();
  } catch (const MachineFault& fault) {
    EXPECT_EQ(fault.kind(), MachineFault::Kind::following_error);
  }
  EXPECT_EQ(driver.calls.back(), "stop");
}

TEST(ExecutePlan, AResumedScanGoesOnWhereItBrokeOff) {
  const ScanPlan plan = two_lines();
  RecordingDriver first;
  const ViewScan whole = execute_plan(first, {}, plan);
  for (std::size_t taken = 1; taken < 6; ++taken) {
    RecordingDriver driver;
    driver.samples = taken;
    std::vector<ProbeSample> kept;
    ExecutionOptions options;
    options.measured_before.assign(whole.samples.begin(), whole.samples.begin() + static_cast<long>(taken));
    options.keep = [&](const ProbeSample& sample) { kept.push_back(sample); };
    const ViewScan resumed = execute_plan(driver, {}, plan, options);
    EXPECT_TRUE(resumed.complete);
    EXPECT_EQ(kept.size(), 6 - taken);
    EXPECT_EQ(driver.calls[2], "skip " + std::to_string(taken / 3) + " " + std::to_string(taken));
    ASSERT_EQ(resumed.points.size(), whole.points.size());
    for (std::size_t i = 0; i < whole.points.size(); ++i)
      EXPECT_EQ(resumed.points.position_mcs_mm[i], whole.points.position_mcs_mm[i]);
    EXPECT_EQ(resumed.time_s, whole.time_s);
  }
}

// The probe looks along -y, the plan leaves the part at y = 40: from inside (y = 3) and to the place of the
// break (y = 0) the probe moves at y = 40.
TEST(ExecutePlan, AResumedScanComesAndGoesAlongTheBeam) {
  ScanPlan plan = two_lines();
  plan.retreat = {{0, 40, 0, 0}};
  RecordingDriver driver;
  driver.present = MachineState::idle;
  driver.at = {7, 3, 5, 1};
  ExecutionOptions options;
  options.measured_before.resize(4);
  execute_plan(driver, {}, plan, options);
  ASSERT_EQ(driver.moves.size(), 4u);
  const auto expect_at = [&](std::size_t k, double x, double y, double z, double theta) {
    EXPECT_EQ(driver.moves[k].x_mm, x);
    EXPECT_EQ(driver.moves[k].y_mm, y);
    EXPECT_EQ(driver.moves[k].z_mm, z);
    EXPECT_EQ(driver.moves[k].theta_rad, theta);
  };
  expect_at(0, 7, 40, 5, 1);
  expect_at(1, 2, 40, 1, 0);
  expect_at(2, 2, 0, 1, 0);
  expect_at(3, 0, 40, 0, 0);
}

// A scan that begins while the probe stands deep in the part first withdraws, too; the way is shown before.
TEST(ExecutePlan, TheFirstWayIsShownBeforeAnythingMoves) {
  ScanPlan plan = two_lines();
  plan.lines[0].approach = {{0, 40, 0, 0}};
  plan.retreat = {{0, 40, 0, 0}};
  RecordingDriver driver;
  driver.present = MachineState::idle;
  driver.at = {7, 3, 5, 0};
  ExecutionOptions options;
  options.check_first_way = [&](const AxisPositions& from, std::span<const AxisPositions> way) {
    EXPECT_TRUE(driver.moves.empty());
    EXPECT_EQ(from.y_mm, 3.0);
    ASSERT_EQ(way.size(), 3u);
    EXPECT_EQ(way[0].x_mm, 7.0);
    EXPECT_EQ(way[0].y_mm, 40.0);
    EXPECT_EQ(way[2].y_mm, 0.0);
    throw InputError("in the way");
  };
  EXPECT_THROW(execute_plan(driver, {}, plan, options), InputError);
  EXPECT_TRUE(driver.moves.empty());
  options.check_first_way = {};
  execute_plan(driver, {}, plan, options);
  EXPECT_EQ(driver.moves[0].x_mm, 7.0);
  EXPECT_EQ(driver.moves[0].y_mm, 40.0);
  EXPECT_EQ(driver.moves[2].y_mm, 0.0);
}

TEST(ExecutePlan, AWayBackOutOfTravelIsRefused) {
  ScanPlan plan = two_lines();
  plan.retreat = {{0, 40, 0, 0}};
  RecordingDriver driver;
  driver.present = MachineState::idle;
  driver.at = {60, 3, 5, 0};
  ExecutionOptions options;
  options.measured_before.resize(4);
  EXPECT_THROW(execute_plan(driver, {}, plan, options), InputError);
  EXPECT_TRUE(driver.moves.empty());
}

TEST(ExecutePlan, AFinishedScanDoesNotMove) {
  RecordingDriver driver;
  ExecutionOptions options;
  options.measured_before.resize(6);
  EXPECT_TRUE(execute_plan(driver, {}, two_lines(), options).complete);
  EXPECT_TRUE(driver.moves.empty());
  options.measured_before.resize(7);
  EXPECT_THROW(execute_plan(driver, {}, two_lines(), options), InputError);
}

TEST(ExecutePlan, ASampleThatCannotBeKeptStopsTheMachine) {
  RecordingDriver driver;
  ExecutionOptions options;
  options.keep = [](const ProbeSample&) { throw MachineFault(MachineFault::Kind::storage, "disk full"); };
  EXPECT_THROW(execute_plan(driver, {}, two_lines(), options), MachineFault);
  EXPECT_EQ(driver.calls.back(), "stop");
}

TEST(ProbeFlags, EveryCombinationSurvivesItsBits) {
  for (std::uint8_t bits = 0; bits < 8; ++bits) EXPECT_EQ(ProbeFlags::from_bits(bits).bits(), bits);
}

}  // namespace
}  // namespace trueblade
