#include "apps/study/run_study.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <map>

#include "apps/interrupt.h"
#include "apps/study/study_progress.h"
#include "apps/version.h"
#include "geometry/error.h"
#include "geometry/fnv1a.h"
#include "part/input_file.h"

namespace trueblade {
namespace {

// Trials that one thread evaluates in one go. Few, so that the last ones finish together.
constexpr std::uint64_t kPiece = 4;
// A transaction waits for the disk; one a second costs nothing and loses no more than a second.
constexpr double kTransactionEvery_s = 1.0;
constexpr std::size_t kLargestTransaction = 20000;  // rows
// A case whose first so many trials, by their numbers, all fail is hopeless: were one trial in ten good, the
// chance of this would be 3 in 100,000.
constexpr std::uint64_t kHopelessAfter = 100;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Notes what comes in until there is enough for a transaction.
class TransactionBuffer {
 public:
  explicit TransactionBuffer(TrialStore& store) : store_(store) {}

  void add(std::vector<Outcome> outcomes) {
    for (Outcome& outcome : outcomes) waiting_.push_back(std::move(outcome));
    if (seconds_since(last_) > kTransactionEvery_s || waiting_.size() >= kLargestTransaction) flush();
  }
  void flush() {
    if (!waiting_.empty()) store_.write(waiting_);
    waiting_.clear();
    last_ = Clock::now();
  }

 private:
  TrialStore& store_;
  std::vector<Outcome> waiting_;
  Clock::time_point last_ = Clock::now();
};

// Stops a study of which a case only fails.
class HopelessCaseWatch {
 public:
  explicit HopelessCaseWatch(const StudyModel& model) : model_(model), failed_(model.cases().size()) {}

  // What is to be done now. By number and not by the order of work: the verdict does not depend on threads.
  void start(const std::vector<TrialRange>& trials) {
    std::uint64_t before = 0;
    for (const TrialRange& range : trials) {
      if (!watched_end_ && before + range.size() >= kHopelessAfter)
        watched_end_ = range.begin + kHopelessAfter - before;
      before += range.size();
    }
  }

  void see(const Outcome& outcome) {
    if (!watched_end_ || outcome.trial >= *watched_end_ || outcome.failure.empty()) return;
    std::map<std::uint64_t, std::string>& failed = failed_[outcome.case_number];
    failed.emplace(outcome.trial, outcome.failure);
    if (failed.size() < kHopelessAfter) return;
    const auto& [first_trial, failure] = *failed.begin();
    throw InputError(fmt::format("case \"{}\": all of its first {} trials failed, first trial {}: {}",
                                 model_.cases()[outcome.case_number].name, kHopelessAfter, first_trial,
                                 failure));
  }

 private:
  const StudyModel& model_;
  std::optional<std::uint64_t> watched_end_;                  // one past the last trial that counts
  std::vector<std::map<std::uint64_t, std::string>> failed_;  // of each case, why
};

std::vector<double> block_values(const TrialStore& store, std::size_t quantity, const TrialRange& block) {
  std::vector<double> values;
  const TrialStore::Cell cell{0, quantity};
  store.for_each_value({&cell, 1}, block, [&](std::uint64_t, std::span<const double> value) {
    if (std::isfinite(value[0])) values.push_back(value[0]);
  });
  return values;
}

}  // namespace

StudyIdentity identity_of(const StudyModel& model) {
  StudyIdentity identity;
  for (const StudyCase& item : model.cases()) {
    Scenario scenario = item.scenario;
    scenario.name = "study";
    scenario.description.clear();
    identity.text += fmt::format("case: {}, views {}\n", item.name,
                                 item.views == ViewPolicy::together ? "together" : "separate");
    // A part is known by what is in its file, wherever it lies.
    if (!scenario.part.file.empty()) {
      identity.text += fmt::format("part file: {:016x}\n", fnv1a(read_file_bytes(scenario.part.file)));
      scenario.part.file = scenario.part.file.filename();
    }
    identity.text += scenario_text(scenario);
    identity.cases.push_back(item.name);
  }
  identity.quantities = model.quantities();
  for (const Quantity& quantity : identity.quantities) identity.text += "quantity: " + quantity.name + "\n";
  identity.hash = fmt::format("{:016x}", fnv1a(identity.text));
  identity.version = fmt::format("{} (commit {})", program_version(), program_commit());
  return identity;
}

std::size_t quantity_number(const StudyModel& model, const std::string& name) {
  const std::vector<Quantity>& list = model.quantities();
  for (std::size_t k = 0; k < list.size(); ++k)
    if (list[k].name == name || list[k].name.ends_with("." + name)) return k;
  return 0;
}

StudyRun run_study(const StudySpec& study, const StudyModel& model, const std::optional<TrialRange>& range,
                   TrialStore& store, Ranks& ranks) {
  const std::size_t headline = quantity_number(model, study.headline);
  StudyProgress progress(study.name, model.quantities()[headline]);
  TransactionBuffer buffer(store);
  HopelessCaseWatch watch(model);
  const TrialFunction evaluate = [&](std::uint64_t trial) { return model.evaluate(trial); };

  const auto complete = [&](const TrialRange& trials) {
    const std::vector<TrialRange> missing = store.missing(trials);
    watch.start(missing);
    TrialQueue queue(missing, kPiece);
    ranks.coordinate([&] { return interrupted() ? std::nullopt : queue.next(); }, evaluate,
                     [&](std::vector<Outcome> outcomes) {
                       for (const Outcome& outcome : outcomes) {
                         watch.see(outcome);
                         if (outcome.case_number == 0)
                           progress.see(outcome.failure.empty() ? outcome.values[headline] : NAN);
                       }
                       buffer.add(std::move(outcomes));
                     });
    buffer.flush();
    return !interrupted();
  };
  const auto count_missing = [&](const TrialRange& trials) {
    std::uint64_t count = 0;
    for (const TrialRange& gap : store.missing(trials)) count += gap.size();
    return count;
  };

  StudyRun run;
  try {
    if (range || !study.tolerance) {
      run.trials = range.value_or(TrialRange{0, study.trials});
      progress.start(count_missing(run.trials));
      run.interrupted = !complete(run.trials);
      return run;
    }
    StudyRun::Stopping stopping;
    stopping.quantity = study.tolerance->quantity;
    stopping.block_size = study.block > 0 ? study.block : standard_block_size(study.coverage_probability);
    StoppingRule rule(
        {study.coverage_probability, study.tolerance->significant_digits, study.tolerance->absolute});
    const std::size_t watched = quantity_number(model, study.tolerance->quantity);
    while (!rule.is_stable() && run.trials.end + stopping.block_size <= study.tolerance->maximum_trials) {
      const TrialRange block{run.trials.end, run.trials.end + stopping.block_size};
      progress.start(count_missing(block));
      if (!complete(block)) {
        run.interrupted = true;
        return run;
      }
      run.trials.end = block.end;
      std::vector<double> values = block_values(store, watched, block);
      if (values.size() < least_trials(study.coverage_probability))
        throw InputError(fmt::format("trials {} to {}: only {} have a value of {}", block.begin, block.end,
                                     values.size(), stopping.quantity));
      rule.add_block(std::move(values));
    }
    stopping.stable = rule.is_stable();
    stopping.blocks = rule.blocks();
    if (rule.blocks() >= 2) {
      const auto errors = rule.twice_standard_errors();
      stopping.largest_twice_standard_error = *std::max_element(errors.begin(), errors.end());
      stopping.tolerance = rule.tolerance();
      stopping.trials_expected = rule.blocks_expected() * static_cast<double>(stopping.block_size);
    }
    run.stopping = stopping;
    return run;
  } catch (const InputError&) {
    buffer.flush();
    throw;
  }
}

}  // namespace trueblade
