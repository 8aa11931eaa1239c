#include "apps/study/study_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>

namespace trueblade {
namespace {

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::lround(seconds));
  if (whole < 3600) return fmt::format("{}:{:02d}", whole / 60, whole % 60);
  return fmt::format("{}:{:02d}:{:02d}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

StudyProgress::StudyProgress(std::string label, Quantity headline)
    : label_(std::move(label)), headline_(std::move(headline)), terminal_(isatty(STDERR_FILENO) == 1) {}

StudyProgress::~StudyProgress() {
  if (terminal_ && drawn_) fmt::print(stderr, "\n");
}

void StudyProgress::start(std::uint64_t trials) {
  total_ = trials;
  done_ = 0;
  started_ = shown_ = Clock::now();
  if (!terminal_) fmt::print(stderr, "trueblade: {}: {} trials to do\n", label_, trials);
}

void StudyProgress::see(double value) {
  ++done_;
  if (std::isfinite(value)) {
    ++values_;
    const double before = value - mean_;
    mean_ += before / static_cast<double>(values_);
    squares_ += before * (value - mean_);
  } else {
    ++failures_;
  }
  // A bar lives, lines in a log should be few.
  const double interval_s = terminal_ ? 0.2 : 10.0;
  if (done_ < total_ && seconds_between(shown_, Clock::now()) < interval_s) return;
  show();
}

void StudyProgress::show() {
  shown_ = Clock::now();
  const double rate = static_cast<double>(done_) / std::max(1e-9, seconds_between(started_, shown_));
  const double left_s = static_cast<double>(total_ - done_) / rate;
  std::string estimate = fmt::format("{:.1f} trials/s, {} left", rate, duration_text(left_s));
  if (values_ > 0) estimate += fmt::format(", {}: mean {:.3g}", headline_.name, mean_);
  if (values_ > 1)
    estimate += fmt::format(", u {:.3g}", std::sqrt(squares_ / static_cast<double>(values_ - 1)));
  if (values_ > 0) estimate += " " + headline_.unit;
  if (failures_ > 0) estimate += fmt::format(", {} failed", failures_);
  if (!terminal_) {
    fmt::print(stderr, "trueblade: {}: {} of {} trials, {}\n", label_, done_, total_, estimate);
    return;
  }
  constexpr std::uint64_t kBarWidth = 24;
  const std::uint64_t filled = done_ * kBarWidth / total_;
  fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {:3d} %  {}\033[K", label_, "", filled, "", kBarWidth - filled,
             done_ * 100 / total_, estimate);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace trueblade
