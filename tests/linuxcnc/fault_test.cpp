// Every fault that a controller and its network can produce, from a scripted controller: each ends in time,
// as a MachineFault of the right kind with the controller's words, motion held or the state unknown,
// everything measured so far kept, and a resume that completes the scan.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "hardware/execute_plan.h"
#include "hardware/recorded/journal.h"
#include "tests/linuxcnc/scripted_controller.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

using Kind = MachineFault::Kind;
constexpr AxisLimits kTravel{{-400, -400, -400, -50}, {400, 400, 400, 50}};

ScanPlan plan_of_two_lines() {
  ScanPlan plan;
  plan.view = "front";
  plan.theta_rad = 0.25;
  plan.columns = 8;
  plan.rows = 2;
  plan.lines.resize(2);
  for (int k = 0; k < 16; ++k) {
    plan.lines[static_cast<std::size_t>(k / 8)].path.push_back({1.0 * (k % 8), -2.0, 0.5 * (k / 8), 0.25});
    plan.grid_index.push_back(static_cast<std::uint32_t>(k));
  }
  plan.lines[0].approach = {{0, 40, 0, 0.25}};
  plan.retreat = {{0, 40, 0, 0.25}};
  return plan;
}

struct Outcome {
  std::optional<Kind> kind;
  std::string words;
  MachineState state = MachineState::disconnected;
  double took_s = 0.0;
  ViewScan scan;
};

// The plan through the driver with a journal in `file`, going on with what it holds.
Outcome scan_with(const LinuxCncSettings& settings, const std::filesystem::path& file) {
  const ScanPlan plan = plan_of_two_lines();
  LinuxCncMachine machine(settings, kTravel, {});
  ExecutionOptions options;
  std::optional<JournalWriter> writer;
  if (std::filesystem::exists(file)) {
    const Journal journal = read_journal(file);
    options.measured_before = journal.views.at(0).samples;
    writer.emplace(JournalWriter::append(file, journal, JournalWriter::Durability::each_view));
  } else {
    writer.emplace(JournalWriter::create(file, JournalWriter::Durability::each_view));
    writer->begin_view(plan);
  }
  options.keep = [&](const ProbeSample& sample) { writer->add(sample); };
  Outcome outcome;
  const auto start = std::chrono::steady_clock::now();
  try {
    outcome.scan = execute_plan(machine, {}, plan, options);
  } catch (const MachineFault& fault) {
    outcome.kind = fault.kind();
    outcome.words = fault.what();
  }
  outcome.took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.state = machine.state();
  return outcome;
}

void expect_whole(const ViewScan& scan) {
  const ScanPlan plan = plan_of_two_lines();
  ASSERT_TRUE(scan.complete);
  ASSERT_EQ(scan.samples.size(), 16u);
  for (std::size_t k = 0; k < 16; ++k) {
    const AxisPositions& planned = plan.lines[k / 8].path[k % 8];
    const ProbeSample& sample = scan.samples[k];
    EXPECT_NEAR(sample.axes.x_mm, planned.x_mm, 1e-6) << k;
    EXPECT_NEAR(sample.axes.z_mm, planned.z_mm, 1e-6) << k;
    EXPECT_NEAR(sample.axes.theta_rad, 0.25, 1e-8) << k;
    // The distance is that of the latched position, not of another period's.
    EXPECT_DOUBLE_EQ(sample.distance_mm, 10.0 + 0.001 * sample.axes.x_mm) << k;
  }
}

// A fault happens, then a well-behaved controller completes what is in the journal.
Outcome fault_then_resume(const Misbehaviour& misbehaviour) {
  const TemporaryFolder folder;
  Outcome outcome;
  {
    ScriptedController controller(misbehaviour);
    outcome = scan_with(controller.settings(), folder / "scan.journal");
  }
  if (outcome.kind) {
    EXPECT_NE(outcome.state, MachineState::idle) << outcome.words;
    EXPECT_NE(outcome.state, MachineState::moving) << outcome.words;
    ScriptedController sound;
    const Outcome resumed = scan_with(sound.settings(), folder / "scan.journal");
    EXPECT_FALSE(resumed.kind) << resumed.words;
    expect_whole(resumed.scan);
    EXPECT_EQ(read_journal(folder / "scan.journal").views.at(0).samples.size(), 16u);
  }
  return outcome;
}

struct Answers {
  std::size_t replies, of_the_stream;
};

Answers answers_of_a_whole_scan() {
  const TemporaryFolder folder;
  ScriptedController controller;
  scan_with(controller.settings(), folder / "scan.journal");
  return {controller.replies_sent(), controller.stream_answers_sent()};
}

TEST(LinuxCncMachine, MeasuresAWholePlan) {
  const TemporaryFolder folder;
  ScriptedController controller;
  const Outcome outcome = scan_with(controller.settings(), folder / "scan.journal");
  EXPECT_FALSE(outcome.kind) << outcome.words;
  EXPECT_EQ(outcome.state, MachineState::idle);
  expect_whole(outcome.scan);
  EXPECT_FALSE(controller.was_aborted());
}

TEST(LinuxCncMachine, NothingMovesBeforeHomingOrBeyondTheLimits) {
  ScriptedController controller;
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  const auto kind_of = [](const auto& work) {
    try {
      work();
    } catch (const MachineFault& fault) {
      return std::optional(fault.kind());
    }
    return std::optional<Kind>();
  };
  EXPECT_EQ(kind_of([&] { machine.move_to({1, 0, 0, 0}); }), Kind::connection);
  machine.connect();
  EXPECT_EQ(machine.state(), MachineState::not_homed);
  EXPECT_EQ(kind_of([&] { machine.move_to({1, 0, 0, 0}); }), Kind::not_homed);
  EXPECT_EQ(kind_of([&] { machine.measure_point(); }), Kind::not_homed);
  machine.home();
  // The machine file's travel is narrower than the controller's in x; in theta too.
  EXPECT_EQ(machine.limits().upper.x_mm, 400.0);
  EXPECT_EQ(kind_of([&] { machine.move_to({401, 0, 0, 0}); }), Kind::limit);
  const std::vector<AxisPositions> path{{0, 0, 0, 0}, {0, 0, 0, std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_EQ(kind_of([&] { machine.scan_line(path, [](const ProbeSample&) { return true; }); }), Kind::limit);
  EXPECT_EQ(machine.position().x_mm, 0.0);
  machine.move_to({3, 0, 0, 0});
  EXPECT_NEAR(machine.position().x_mm, 3.0, 1e-9);
  EXPECT_NEAR(machine.measure_point().distance_mm, 10.003, 1e-9);
}

TEST(LinuxCncFault, ASinkThatHasEnoughStopsTheMachine) {
  ScriptedController controller;
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  machine.connect();
  machine.home();
  const ScanPlan plan = plan_of_two_lines();
  machine.move_to(plan.lines[0].path[0]);
  std::size_t taken = 0;
  EXPECT_EQ(machine.scan_line(plan.lines[0].path, [&](const ProbeSample&) { return ++taken < 3; }), 3u);
  EXPECT_EQ(machine.state(), MachineState::stopped);
  EXPECT_TRUE(controller.was_held());
  EXPECT_TRUE(controller.was_aborted());
}

std::optional<Kind> kind_of_fault(const std::function<void()>& work) {
  try {
    work();
  } catch (const MachineFault& fault) {
    return fault.kind();
  }
  return std::nullopt;
}

TEST(LinuxCncFault, AStopEndsHoming) {
  Misbehaviour misbehaviour;
  misbehaviour.homing_periods = 1'000'000;
  ScriptedController controller(misbehaviour);
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  int asked = 0;
  machine.stop_when([&] { return ++asked > 3; });
  machine.connect();
  EXPECT_EQ(kind_of_fault([&] { machine.home(); }), Kind::interrupted);
  EXPECT_TRUE(controller.was_watched());
  EXPECT_TRUE(controller.was_held());
  EXPECT_TRUE(controller.was_aborted());
  EXPECT_EQ(machine.state(), MachineState::stopped);
}

TEST(LinuxCncFault, HomingThatTheWatchdogEndedIsNoticedAtOnce) {
  Misbehaviour misbehaviour;
  misbehaviour.homing_periods = 1'000'000;
  misbehaviour.watchdog_ends_homing = true;
  ScriptedController controller(misbehaviour);
  LinuxCncSettings settings = controller.settings();
  settings.home_timeout_s = 60.0;
  LinuxCncMachine machine(settings, kTravel, {});
  machine.connect();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(kind_of_fault([&] { machine.home(); }), Kind::interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_EQ(machine.state(), MachineState::stopped);
}

TEST(LinuxCncFault, HomingThatTakesLongerThanTheWatchdogIsWatchedAllTheWhile) {
  Misbehaviour misbehaviour;
  misbehaviour.homing_periods = 600;
  ScriptedController controller(misbehaviour);
  LinuxCncSettings settings = controller.settings();
  settings.home_timeout_s = 30.0;
  LinuxCncMachine machine(settings, kTravel, {});
  machine.connect();
  machine.home();
  EXPECT_TRUE(controller.was_watched());
  EXPECT_LT(controller.longest_without_sign_s(), SampleStream::kWatchdogS);
  EXPECT_EQ(machine.state(), MachineState::idle);
}

TEST(LinuxCncFault, AStopEndsAMove) {
  ScriptedController controller;
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  bool stop = false;
  machine.stop_when([&] { return stop; });
  machine.connect();
  machine.home();
  stop = true;
  EXPECT_EQ(kind_of_fault([&] { machine.move_to({300, 0, 0, 0}); }), Kind::interrupted);
  EXPECT_TRUE(controller.was_held());
  EXPECT_TRUE(controller.was_aborted());
  EXPECT_EQ(machine.state(), MachineState::stopped);
}

TEST(LinuxCncFault, AScanThatIsAskedToStopKeepsWhatItMeasured) {
  ScriptedController controller;
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  std::size_t kept = 0;
  ExecutionOptions options;
  options.keep = [&](const ProbeSample&) { ++kept; };
  options.stop_asked = [&] { return kept >= 8; };
  machine.stop_when(options.stop_asked);
  const ViewScan scan = execute_plan(machine, {}, plan_of_two_lines(), options);
  EXPECT_FALSE(scan.complete);
  EXPECT_EQ(scan.samples.size(), 8u);
  EXPECT_EQ(machine.state(), MachineState::stopped);
}

TEST(LinuxCncFault, WhoIsCutOffAtRestDoesNotKnowWhatTheMachineDoes) {
  Misbehaviour misbehaviour;
  const std::size_t to_come_home = 2;  // the greeting, the sample at connecting; homing takes a third
  misbehaviour.stream_answers = [&](std::size_t n, const std::string& frame) {
    return n > to_come_home ? std::nullopt : std::optional(frame);
  };
  ScriptedController controller(misbehaviour);
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  machine.connect();
  machine.home();
  EXPECT_EQ(machine.state(), MachineState::idle);
  EXPECT_EQ(kind_of_fault([&] { machine.move_to({1, 0, 0, 0}); }), Kind::connection);
  EXPECT_EQ(machine.state(), MachineState::unknown);
}

TEST(LinuxCncFault, NobodyThere) {
  LinuxCncSettings settings;
  {
    const ScriptedController controller;
    settings = controller.settings();
  }
  const TemporaryFolder folder;
  const Outcome outcome = scan_with(settings, folder / "scan.journal");
  EXPECT_EQ(outcome.kind, Kind::connection);
  EXPECT_NE(outcome.words.find("refused"), std::string::npos) << outcome.words;
  EXPECT_EQ(outcome.state, MachineState::disconnected);
}

TEST(LinuxCncFault, WrongPasswords) {
  for (const bool connect : {true, false}) {
    ScriptedController controller;
    LinuxCncSettings settings = controller.settings();
    (connect ? settings.commands.connect_password : settings.commands.enable_password) = "guess";
    const TemporaryFolder folder;
    const Outcome outcome = scan_with(settings, folder / "scan.journal");
    EXPECT_EQ(outcome.kind, Kind::connection);
    EXPECT_NE(outcome.words.find("password"), std::string::npos) << outcome.words;
  }
}

// At every reply of the whole scan: the connection is cut; garbage; a line without end; an answer to another
// question.
TEST(LinuxCncFault, AtEveryStepOfTheProtocol) {
  const std::size_t replies = answers_of_a_whole_scan().replies;
  ASSERT_GT(replies, 20u);
  using Replies = std::function<std::optional<std::string>(const std::string&)>;
  const std::vector<std::pair<const char*, Replies>> ways{
      {"cut", [](const std::string&) { return std::nullopt; }},
      {"garbage",
       [](const std::string&) {
         return std::string("\x01\xff\x80 \x7f\r\n\r\n").append(64, '\n') + std::string(2000, '\xee') +
                "\r\nGARBAGE 1 2 3\r\n";
       }},
      {"other", [](const std::string&) { return "PROGRAM_LINE 7\r\n"; }}};
  for (const auto& [name, way] : ways)
    for (std::size_t step = 0; step < replies; step += name == std::string("cut") ? 1 : 7) {
      SCOPED_TRACE(std::string(name) + " at reply " + std::to_string(step));
      Misbehaviour misbehaviour;
      misbehaviour.replies = [&way = way, step](std::size_t n, const std::string& reply) {
        return n == step ? way(reply) : std::optional(reply);
      };
      const Outcome outcome = fault_then_resume(misbehaviour);
      // The reply to "set echo off" is passed over, so that a stray line in its place is none.
      if (!outcome.kind) {
        EXPECT_LE(step, 1u);
        continue;
      }
      EXPECT_TRUE(*outcome.kind == Kind::connection || *outcome.kind == Kind::protocol) << outcome.words;
      EXPECT_LT(outcome.took_s, 4.0);
    }
}

// The greeting, and the answers to "samples" and "program": cut at each; silence and damage at some.
TEST(LinuxCncFault, AtEveryAnswerOfTheSampleStream) {
  const std::size_t answers = answers_of_a_whole_scan().of_the_stream;
  ASSERT_GT(answers, 8u);
  for (const char* way : {"cut", "silence", "damaged"})
    for (std::size_t step = 0; step < answers; step += way == std::string("cut") ? 1 : 3) {
      SCOPED_TRACE(std::string(way) + " at answer " + std::to_string(step));
      Misbehaviour misbehaviour;
      misbehaviour.stream_answers = [&](std::size_t n, std::string frame) -> std::optional<std::string> {
        if (n != step) return frame;
        if (way == std::string("cut")) return std::nullopt;
        if (way == std::string("silence")) return "";
        frame.back() = static_cast<char>(frame.back() ^ 1);
        return frame;
      };
      const Outcome outcome = fault_then_resume(misbehaviour);
      ASSERT_TRUE(outcome.kind);
      EXPECT_EQ(*outcome.kind, way == std::string("damaged") ? Kind::protocol : Kind::connection)
          << outcome.words;
      EXPECT_LT(outcome.took_s, 4.0);
    }
}

TEST(LinuxCncFault, AnswersThatAreLateButInTimeAreNoFault) {
  for (const double delay_s : {0.01, 0.03, 0.06, 0.12}) {
    SCOPED_TRACE(delay_s);
    Misbehaviour misbehaviour;
    misbehaviour.delay_s = [=](std::size_t) { return delay_s; };
    const TemporaryFolder folder;
    ScriptedController controller(misbehaviour);
    const Outcome outcome = scan_with(controller.settings(), folder / "scan.journal");
    EXPECT_FALSE(outcome.kind) << outcome.words;
    expect_whole(outcome.scan);
  }
}

// A controller that is slow to answer is not taken for a program that has died.
TEST(LinuxCncFault, SignsOfLifeGoOnWhileAnAnswerIsWaitedFor) {
  std::atomic<bool> is_late = false;
  Misbehaviour misbehaviour;
  misbehaviour.delay_s = [&](std::size_t) { return is_late ? 1.4 * SampleStream::kWatchdogS : 0.0; };
  ScriptedController controller(misbehaviour);
  LinuxCncSettings settings = controller.settings();
  settings.commands.timeout_s = 5.0;
  LinuxCncMachine machine(settings, kTravel, {});
  machine.connect();
  machine.home();
  is_late = true;
  machine.move_to({3, 0, 0, 0});
  EXPECT_EQ(machine.state(), MachineState::idle);
  EXPECT_LT(controller.longest_without_sign_s(), SampleStream::kWatchdogS);
}

void expect_end_by_the_time_out(const Outcome& outcome) {
  ASSERT_TRUE(outcome.kind);
  EXPECT_EQ(*outcome.kind, Kind::connection) << outcome.words;
  EXPECT_LT(outcome.took_s, 4.0);
}

TEST(LinuxCncFault, AnAnswerLaterThanTheTimeOut) {
  const std::size_t replies = answers_of_a_whole_scan().replies;
  for (const std::size_t step : {std::size_t{0}, std::size_t{9}, replies / 2, replies - 3}) {
    SCOPED_TRACE(step);
    Misbehaviour misbehaviour;
    misbehaviour.delay_s = [=](std::size_t n) { return n == step ? 0.7 : 0.0; };
    expect_end_by_the_time_out(fault_then_resume(misbehaviour));
  }
}

TEST(LinuxCncFault, HalfALineAndSilenceEndByTheTimeOut) {
  const std::size_t replies = answers_of_a_whole_scan().replies;
  for (const std::size_t step : {std::size_t{0}, std::size_t{2}, std::size_t{9}, replies / 2, replies - 3}) {
    for (const char* way : {"half", "silence"}) {
      SCOPED_TRACE(std::string(way) + " at reply " + std::to_string(step));
      Misbehaviour misbehaviour;
      misbehaviour.replies = [&](std::size_t n, const std::string& reply) -> std::optional<std::string> {
        if (n != step) return reply;
        return way == std::string("half") ? reply.substr(0, reply.size() / 2) : "";
      };
      expect_end_by_the_time_out(fault_then_resume(misbehaviour));
    }
  }
}

TEST(LinuxCncFault, AnswersInTheWrongOrderAreNotTakenForOneAnother) {
  const std::size_t replies = answers_of_a_whole_scan().replies;
  for (std::size_t step = 2; step + 1 < replies; step += 11) {
    std::string withheld;
    Misbehaviour misbehaviour;
    misbehaviour.replies = [&](std::size_t n, const std::string& reply) -> std::optional<std::string> {
      if (n == step) {
        withheld = reply;
        return "PROGRAM_UNITS MM\r\n" + reply;
      }
      return reply;
    };
    const Outcome outcome = fault_then_resume(misbehaviour);
    ASSERT_TRUE(outcome.kind) << step;
    EXPECT_EQ(*outcome.kind, Kind::protocol) << outcome.words;
  }
}

TEST(LinuxCncFault, AVeryLongLineTakesNoMemoryAndEndsInTime) {
  Misbehaviour misbehaviour;
  misbehaviour.replies = [](std::size_t n, const std::string& reply) -> std::optional<std::string> {
    return n == 5 ? std::string(1'000'000, 'A') : reply;
  };
  const Outcome outcome = fault_then_resume(misbehaviour);
  ASSERT_TRUE(outcome.kind);
  EXPECT_EQ(*outcome.kind, Kind::connection) << outcome.words;
  EXPECT_LT(outcome.took_s, 4.0);
}

TEST(LinuxCncFault, TheStreamOfSamples) {
  using Samples =
      std::function<std::optional<std::string>(const std::string& frame, const LatchedSample& sample)>;
  struct Way {
    const char* name;
    Samples samples;
    Kind kind;
  };
  const std::vector<Way> ways{
      {"cut", [](const std::string&, const LatchedSample&) { return std::nullopt; }, Kind::connection},
      {"lost", [](const std::string&, const LatchedSample&) { return ""; }, Kind::sensor},
      {"doubled", [](const std::string& frame, const LatchedSample&) { return frame + frame; }, Kind::sensor},
      {"damaged",
       [](std::string frame, const LatchedSample&) {
         frame[20] = static_cast<char>(frame[20] ^ 1);
         return frame;
       },
       Kind::protocol},
      {"garbage", [](const std::string&, const LatchedSample&) { return std::string(100, '\x55'); },
       Kind::protocol},
      {"the watchdog has bitten",
       [](const std::string& frame, const LatchedSample&) {
         return frame + frame_bytes(StreamFrame::Type::motion_ended, "");
       },
       Kind::interrupted}};
  for (const Way& way : ways)
    for (const std::size_t step : {0u, 1u, 12u, 20u}) {
      SCOPED_TRACE(std::string(way.name) + " at sample " + std::to_string(step));
      Misbehaviour misbehaviour;
      // Only in programs that measure, so that samples have been taken before.
      misbehaviour.samples = [&way, step](std::size_t n,
                                          const LatchedSample& sample) -> std::optional<std::string> {
        const std::string frame = frame_bytes(StreamFrame::Type::sample, sample_payload(sample));
        return n == step && sample.first_point >= 0.0 ? way.samples(frame, sample) : std::optional(frame);
      };
      const Outcome outcome = fault_then_resume(misbehaviour);
      if (!outcome.kind) {
        EXPECT_EQ(step, 0u);  // the first sample of a program still carries the mark of the one before
        continue;
      }
      EXPECT_EQ(*outcome.kind, way.kind) << outcome.words;
      const bool out_of_sight = way.kind == Kind::connection || way.kind == Kind::protocol;
      EXPECT_EQ(outcome.state, out_of_sight ? MachineState::unknown : MachineState::stopped);
    }
}

TEST(LinuxCncFault, ASilentSensor) {
  Misbehaviour misbehaviour;
  misbehaviour.samples = [](std::size_t n, const LatchedSample& sample) -> std::optional<std::string> {
    LatchedSample silent = sample;
    if (sample.first_point >= 0.0 && n > 8) silent.reading = 1;
    return frame_bytes(StreamFrame::Type::sample, sample_payload(silent));
  };
  const Outcome outcome = fault_then_resume(misbehaviour);
  ASSERT_TRUE(outcome.kind);
  EXPECT_EQ(*outcome.kind, Kind::sensor) << outcome.words;
  EXPECT_EQ(outcome.state, MachineState::stopped);
}

TEST(LinuxCncFault, AMoveNeedsNoSensor) {
  Misbehaviour misbehaviour;
  misbehaviour.samples = [](std::size_t, LatchedSample sample) -> std::optional<std::string> {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    sample.reading = 1;
    return frame_bytes(StreamFrame::Type::sample, sample_payload(sample));
  };
  ScriptedController controller(misbehaviour);
  LinuxCncMachine machine(controller.settings(), kTravel, {});
  machine.connect();
  machine.home();
  std::vector<AxisPositions> way;  // 3 samples each: longer than the sensor may be silent
  for (int k = 1; k <= 20; ++k) way.push_back({1.0 * k, 0, 0, 0});
  machine.move_through(way);
  EXPECT_NEAR(machine.position().x_mm, 20.0, 1e-9);
}

TEST(LinuxCncFault, EmergencyStopFollowingErrorAndLimitCarryTheControllersWords) {
  struct Case {
    void (*set)(Misbehaviour&);
    Kind kind;
    const char* words;
  };
  for (const Case& c :
       {Case{[](Misbehaviour& m) { m.in_estop = true; }, Kind::emergency_stop, "e-stop"},
        Case{[](Misbehaviour& m) {
               m.error_words = "joint 1 following error";
               m.joint_fault = true;
             },
             Kind::following_error, "joint 1 following error"},
        Case{[](Misbehaviour& m) { m.error_words = "Linear move on line 7 would exceed X's positive limit"; },
             Kind::limit, "would exceed X's positive limit"}}) {
    Misbehaviour misbehaviour;
    c.set(misbehaviour);
    if (!misbehaviour.in_estop)  // the axes go off in the middle of a line
      misbehaviour.samples = [](std::size_t n, const LatchedSample& sample) -> std::optional<std::string> {
        LatchedSample off = sample;
        if (sample.first_point >= 0.0 && n > 12) off.motion_enabled = false;
        return frame_bytes(StreamFrame::Type::sample, sample_payload(off));
      };
    SCOPED_TRACE(c.words);
    const Outcome outcome = fault_then_resume(misbehaviour);
    ASSERT_TRUE(outcome.kind);
    EXPECT_EQ(*outcome.kind, c.kind) << outcome.words;
    EXPECT_NE(outcome.words.find(c.words), std::string::npos) << outcome.words;
    EXPECT_EQ(outcome.state, MachineState::stopped);
  }
}

TEST(LinuxCncFault, ALineWithoutAnyReadingInRangeIsNoFault) {
  Misbehaviour misbehaviour;
  misbehaviour.samples = [](std::size_t, const LatchedSample& sample) -> std::optional<std::string> {
    LatchedSample out = sample;
    if (sample.axes[2] < 0.25) out.flags = 1;  // out of range in the first line
    return frame_bytes(StreamFrame::Type::sample, sample_payload(out));
  };
  const TemporaryFolder folder;
  ScriptedController controller(misbehaviour);
  const Outcome outcome = scan_with(controller.settings(), folder / "scan.journal");
  EXPECT_FALSE(outcome.kind) << outcome.words;
  EXPECT_TRUE(outcome.scan.complete);
  EXPECT_EQ(outcome.scan.samples.size(), 16u);
  EXPECT_EQ(outcome.scan.points.size(), 8u);
}

TEST(LinuxCncFault, AnEmergencyStopIsNotResetUnasked) {
  ScriptedController controller;
  LinuxCncSettings settings = controller.settings();
  settings.reset_estop = false;
  LinuxCncMachine machine(settings, kTravel, {});
  machine.connect();
  EXPECT_THROW(machine.home(), MachineFault);  // the machine is off, and stays so
  EXPECT_EQ(machine.state(), MachineState::not_homed);
}

}  // namespace
}  // namespace trueblade
