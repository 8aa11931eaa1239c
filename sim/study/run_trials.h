// Runs trials on all threads of the process.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "sim/study/trial.h"

namespace trueblade {

// Gives out the trials of several ranges in pieces of at most `piece` trials, each once, to any number of
// threads.
class TrialQueue {
 public:
  TrialQueue(std::vector<TrialRange> ranges, std::uint64_t piece);
  std::optional<TrialRange> next();  // nullopt: none is left

 private:
  std::mutex mutex_;
  std::vector<TrialRange> ranges_;
  std::size_t at_ = 0;
  std::uint64_t piece_;
};

// Where the next piece of work comes from; nullopt ends the work. Called by one thread at a time.
using NextTrials = std::function<std::optional<TrialRange>()>;
// What becomes of the finished pieces, in any order. Called by one thread at a time.
using TakeOutcomes = std::function<void(std::vector<Outcome>)>;

// Evaluates pieces until `next` has none. Each trial runs on one thread, so that the threads need not wait
// for each other; evaluation, and taking outcomes in, go on at the same time. An exception of any function
// ends the work and is passed on.
void run_trials(const NextTrials& next, const TrialFunction& evaluate, const TakeOutcomes& take);

}  // namespace trueblade
