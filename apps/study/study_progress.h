// What the user sees while a study runs: how far, how fast, how long still, and the estimate so far.
#pragma once

#include <chrono>
#include <string>

#include "sim/study/trial.h"

namespace trueblade {

class StudyProgress {
 public:
  StudyProgress(std::string label, Quantity headline);
  ~StudyProgress();  // ends the bar's line
  StudyProgress(const StudyProgress&) = delete;
  StudyProgress& operator=(const StudyProgress&) = delete;

  void start(std::uint64_t trials);  // that are to come now
  void see(double value);            // of one trial; NaN: it failed

 private:
  void show();

  std::string label_;
  Quantity headline_;
  bool terminal_;
  bool drawn_ = false;
  std::uint64_t total_ = 0, done_ = 0;
  std::uint64_t values_ = 0, failures_ = 0;
  double mean_ = 0.0, squares_ = 0.0;  // running mean and sum of squared deviations (Welford 1962)
  using Clock = std::chrono::steady_clock;
  Clock::time_point started_, shown_;
};

}  // namespace trueblade
