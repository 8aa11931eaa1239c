#include "sim/study/run_trials.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>

#include "geometry/parallel.h"

namespace trueblade {

TrialQueue::TrialQueue(std::vector<TrialRange> ranges, std::uint64_t piece)
    : ranges_(std::move(ranges)), piece_(piece) {}

std::optional<TrialRange> TrialQueue::next() {
  const std::lock_guard lock(mutex_);
  while (at_ < ranges_.size() && ranges_[at_].size() == 0) ++at_;
  if (at_ == ranges_.size()) return std::nullopt;
  TrialRange& range = ranges_[at_];
  const TrialRange taken{range.begin, std::min(range.end, range.begin + piece_)};
  range.begin = taken.end;
  return taken;
}

void run_trials(const NextTrials& next, const TrialFunction& evaluate, const TakeOutcomes& take) {
  using Outcomes = std::shared_ptr<std::vector<Outcome>>;
  // An exception that left a filter would leave the outcomes on their way behind. So the first one is kept,
  // no more trials begin, and it goes on when the pipeline is empty.
  std::mutex mutex;
  std::exception_ptr failure;
  const auto has_failed = [&] {
    const std::lock_guard lock(mutex);
    return failure != nullptr;
  };
  const auto unless_failed = [&](const auto& action) {
    if (has_failed()) return;
    try {
      action();
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  const auto give = [&](tbb::flow_control& flow) {
    std::optional<TrialRange> trials;
    unless_failed([&] { trials = next(); });
    if (!trials) flow.stop();
    return trials.value_or(TrialRange{});
  };
  const auto work = [&](const TrialRange& trials) {
    const SerialLoops one_thread;
    auto outcomes = std::make_shared<std::vector<Outcome>>();
    unless_failed([&] {
      for (std::uint64_t trial = trials.begin; trial < trials.end; ++trial)
        for (Outcome& outcome : evaluate(trial)) outcomes->push_back(std::move(outcome));
    });
    return outcomes;
  };
  const auto take_them = [&](const Outcomes& outcomes) {
    unless_failed([&] { take(std::move(*outcomes)); });
  };
  // Two pieces for each thread: one in work, one finished and waiting to be taken.
  const auto tokens = 2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  tbb::parallel_pipeline(
      tokens, tbb::make_filter<void, TrialRange>(tbb::filter_mode::serial_in_order, give) &
                  tbb::make_filter<TrialRange, Outcomes>(tbb::filter_mode::parallel, work) &
                  tbb::make_filter<Outcomes, void>(tbb::filter_mode::serial_out_of_order, take_them));
  if (failure) std::rethrow_exception(failure);
}

}  // namespace trueblade
