// The journal: what is written reads back; the end torn at any byte, and any byte damaged, cost no record
// before it; a process killed in the middle of a scan has lost nothing that was measured, and the scan goes
// on to the same result; a full disk; replay through the driver's interface.
#include "hardware/recorded/journal.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "geometry/error.h"
#include "hardware/execute_plan.h"
#include "hardware/recorded/recorded_machine.h"
#include "tests/hardware/same_sample.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

constexpr AxisLimits kLimits{{-500, -500, -500, -100}, {500, 500, 500, 100}};

ProbeSample sample_number(std::size_t k) {
  const double t = static_cast<double>(k);
  ProbeSample sample;
  sample.axes = {0.1 * t, -1.0 / 3.0, 1e-3 * t, 0.25};
  sample.distance_mm = 10.0 + 1e-7 * t;
  sample.snr = 1.0 / (1.0 + t);
  sample.time_s = 0.001 * t;
  sample.flags = ProbeFlags::from_bits(static_cast<std::uint8_t>(k % 8));
  return sample;
}

// Two lines of 20 positions each, where sample_number puts its samples.
ScanPlan plan_of_40(const std::string& view = "front") {
  ScanPlan plan;
  plan.view = view;
  plan.theta_rad = 0.25;
  plan.columns = 20;
  plan.rows = 2;
  plan.lines.resize(2);
  for (std::size_t k = 0; k < 40; ++k) {
    plan.lines[k / 20].path.push_back(sample_number(k).axes);
    plan.grid_index.push_back(static_cast<std::uint32_t>(k));
  }
  return plan;
}

// A machine whose samples depend on their running number alone.
class CountingMachine : public MachineDriver {
 public:
  std::size_t count = 0;
  void connect() override {}
  void home() override {}
  void move_to(const AxisPositions&) override {}
  ProbeSample measure_point() override { return sample_number(count++); }
  std::size_t scan_line(std::span<const AxisPositions> path, const SampleSink& sink) override {
    std::size_t delivered = 0;
    while (delivered < path.size()) {
      ++delivered;
      if (!sink(measure_point())) break;
    }
    return delivered;
  }
  void skip_measured(const MeasuredBefore& before) override { count += before.samples; }
  void stop() noexcept override {}
  MachineState state() const override { return MachineState::idle; }
  AxisPositions position() const override { return {}; }
  AxisLimits limits() const override { return kLimits; }
};

// A journal of one view with `count` samples; its bytes, and where each record ends.
struct Written {
  std::string bytes;
  std::vector<std::size_t> ends;
};
Written write_journal(const std::filesystem::path& file, std::size_t count) {
  Written written;
  JournalWriter writer = JournalWriter::create(file, JournalWriter::Durability::each_view);
  const auto note_end = [&] { written.ends.push_back(std::filesystem::file_size(file)); };
  note_end();
  writer.begin_view(plan_of_40());
  note_end();
  for (std::size_t k = 0; k < count; ++k) {
    writer.add(sample_number(k));
    note_end();
  }
  written.bytes = bytes_of(file);
  return written;
}

TEST(Journal, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const auto file = folder / "scan.journal";
  {
    JournalWriter writer = JournalWriter::create(file, JournalWriter::Durability::each_sample);
    for (const char* view : {"front", "back"}) {
      writer.begin_view(plan_of_40(view));
      for (std::size_t k = 0; k < 40; ++k) writer.add(sample_number(k));
      if (view == std::string("front")) writer.end_view();
    }
    writer.note("e-stop");
  }
  const Journal journal = read_journal(file);
  ASSERT_EQ(journal.views.size(), 2u);
  EXPECT_TRUE(journal.views[0].complete);
  EXPECT_FALSE(journal.views[1].complete);
  EXPECT_EQ(journal.find("back")->digest, plan_digest(plan_of_40("back")));
  EXPECT_EQ(journal.find("back")->planned, 40u);
  EXPECT_EQ(journal.notes, std::vector<std::string>{"e-stop"});
  EXPECT_EQ(journal.discarded_bytes, 0u);
  for (const JournalledView& view : journal.views) {
    ASSERT_EQ(view.samples.size(), 40u);
    for (std::size_t k = 0; k < 40; ++k) expect_same(view.samples[k], sample_number(k));
  }
}

TEST(Journal, ATornEndCostsNoRecordBeforeIt) {
  const TemporaryFolder folder;
  const Written written = write_journal(folder / "scan.journal", 3);
  for (std::size_t size = written.ends[0]; size <= written.bytes.size(); ++size) {
    const Journal journal = read_journal_bytes(written.bytes.substr(0, size), "torn");
    std::size_t records = 0;
    while (records + 1 < written.ends.size() && written.ends[records + 1] <= size) ++records;
    EXPECT_EQ(journal.sound_bytes, written.ends[records]) << size;
    EXPECT_EQ(journal.views.empty() ? 0 : 1 + journal.views[0].samples.size(), records) << size;
  }
}

TEST(Journal, ADamagedByteIsFoundAndCostsNothingBeforeIt) {
  const TemporaryFolder folder;
  const Written written = write_journal(folder / "scan.journal", 3);
  for (std::size_t at = written.ends[0]; at < written.bytes.size(); ++at) {
    std::string damaged = written.bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const Journal journal = read_journal_bytes(damaged, "damaged");
    std::size_t before = 0;
    while (written.ends[before + 1] <= at) ++before;
    EXPECT_EQ(journal.sound_bytes, written.ends[before]) << at;
  }
}

TEST(Journal, WhatIsNoJournalIsRefused) {
  EXPECT_THROW(read_journal_bytes("", "empty"), InputError);
  EXPECT_THROW(read_journal_bytes("ply\nformat ascii 1.0\n", "scan.ply"), InputError);
  EXPECT_THROW(read_journal("/nowhere/scan.journal"), InputError);
}

TEST(Journal, KilledInTheMiddleOfAScanItGoesOnToTheSameResult) {
  const TemporaryFolder folder;
  const ScanPlan plan = plan_of_40();
  CountingMachine undisturbed;
  const ViewScan whole = execute_plan(undisturbed, {}, plan);
  for (const std::size_t killed_at : {1u, 7u, 20u, 33u}) {
    const auto file = folder / ("killed_" + std::to_string(killed_at));
    const pid_t child = fork();
    if (child == 0) {
      JournalWriter writer = JournalWriter::create(file, JournalWriter::Durability::each_view);
      writer.begin_view(plan);
      CountingMachine machine;
      ExecutionOptions options;
      options.keep = [&](const ProbeSample& sample) { writer.add(sample); };
      options.progress = [&](std::size_t taken, std::size_t) {
        if (taken == killed_at) raise(SIGKILL);
        return true;
      };
      execute_plan(machine, {}, plan, options);
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    // The kill may come in the middle of a record.
    std::ofstream(file, std::ios::app | std::ios::binary) << std::string("\2\71\0\0\0half a rec", 15);

    const Journal journal = read_journal(file);
    ASSERT_EQ(journal.views.size(), 1u);
    EXPECT_EQ(journal.views[0].samples.size(), killed_at);
    EXPECT_EQ(journal.discarded_bytes, 15u);
    {
      JournalWriter writer = JournalWriter::append(file, journal, JournalWriter::Durability::each_view);
      CountingMachine machine;
      ExecutionOptions options;
      options.measured_before = journal.views[0].samples;
      options.keep = [&](const ProbeSample& sample) { writer.add(sample); };
      const ViewScan resumed = execute_plan(machine, {}, plan, options);
      writer.end_view();
      ASSERT_EQ(resumed.samples.size(), whole.samples.size());
      for (std::size_t k = 0; k < 40; ++k) expect_same(resumed.samples[k], whole.samples[k]);
    }
    const Journal finished = read_journal(file);
    EXPECT_EQ(finished.discarded_bytes, 0u);
    EXPECT_TRUE(finished.views[0].complete);
    EXPECT_EQ(finished.views[0].samples.size(), 40u);
  }
}

TEST(Journal, AFullDiskIsAFaultAndTheJournalStaysSound) {
  EXPECT_THROW(JournalWriter::create("/dev/full", JournalWriter::Durability::each_view), MachineFault);

  // A limit on the file's size stands for the disk: the record that does not fit is cut off again.
  const TemporaryFolder folder;
  const auto file = folder / "scan.journal";
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    JournalWriter writer = JournalWriter::create(file, JournalWriter::Durability::each_sample);
    writer.begin_view(plan_of_40());
    for (std::size_t k = 0; k < 2; ++k) writer.add(sample_number(k));
    const rlimit limit{std::filesystem::file_size(file) + 30, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      writer.add(sample_number(2));
    } catch (const MachineFault& fault) {
      _exit(fault.kind() == MachineFault::Kind::storage ? 3 : 1);
    }
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
  const Journal journal = read_journal(file);
  EXPECT_EQ(journal.discarded_bytes, 0u);
  EXPECT_EQ(journal.views[0].samples.size(), 2u);
}

TEST(RecordedMachine, ReplaysThroughTheSameInterface) {
  const TemporaryFolder folder;
  write_journal(folder / "scan.journal", 40);
  RecordedMachine machine(read_journal(folder / "scan.journal"), "scan.journal", kLimits);
  const ViewScan replayed = execute_plan(machine, {}, plan_of_40());
  CountingMachine original;
  const ViewScan measured = execute_plan(original, {}, plan_of_40());
  ASSERT_TRUE(replayed.complete);
  for (std::size_t k = 0; k < 40; ++k) expect_same(replayed.samples[k], measured.samples[k]);
}

TEST(RecordedMachine, AnotherPlanAndAShortJournalAreFaults) {
  const TemporaryFolder folder;
  write_journal(folder / "scan.journal", 25);
  const Journal journal = read_journal(folder / "scan.journal");
  RecordedMachine short_machine(journal, "scan.journal", kLimits);
  try {
    execute_plan(short_machine, {}, plan_of_40());
    FAIL();
  } catch (const MachineFault& fault) {
    EXPECT_STREQ(fault.what(), "scan.journal: the journal ends after 25 samples");
  }
  ScanPlan other = plan_of_40();
  other.lines[0].path[3].z_mm += 1.0;
  RecordedMachine other_machine(journal, "scan.journal", kLimits);
  try {
    execute_plan(other_machine, {}, other);
    FAIL();
  } catch (const MachineFault& fault) {
    EXPECT_EQ(fault.kind(), MachineFault::Kind::protocol);
  }
}

TEST(PlanDigest, ChangesWithEveryPartOfThePlan) {
  const std::uint64_t digest = plan_digest(plan_of_40());
  EXPECT_EQ(digest, plan_digest(plan_of_40()));
  EXPECT_NE(digest, plan_digest(plan_of_40("back")));
  ScanPlan moved = plan_of_40();
  moved.lines[1].path[19].x_mm += 1e-12;
  EXPECT_NE(digest, plan_digest(moved));
  ScanPlan split = plan_of_40();  // the same positions in other lines
  split.lines[1].path.insert(split.lines[1].path.begin(), split.lines[0].path.back());
  split.lines[0].path.pop_back();
  EXPECT_NE(digest, plan_digest(split));
}

}  // namespace
}  // namespace trueblade
