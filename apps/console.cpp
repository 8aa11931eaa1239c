#include "apps/console.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>

namespace trueblade {

void start_log() {
  // Tests run the command line several times in one process; the logger is made once.
  if (!spdlog::get("trueblade")) spdlog::set_default_logger(spdlog::stderr_color_mt("trueblade"));
  spdlog::set_pattern("trueblade: %^%v%$");
  spdlog::set_level(spdlog::level::info);
}

Progress::Progress(std::string label) : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_ && drawn_) fmt::print(stderr, "\n");
}

void Progress::report(std::size_t done, std::size_t total) {
  if (total == 0 || !spdlog::should_log(spdlog::level::info)) return;
  // A bar has a hundred steps, plain lines come at every tenth.
  const std::size_t steps = terminal_ ? 100 : 10;
  const std::size_t step = done * steps / total;
  if (step == last_step_) return;
  last_step_ = step;
  if (!terminal_) {
    fmt::print(stderr, "trueblade: {}: {} of {}\n", label_, done, total);
    return;
  }
  constexpr std::size_t kBarWidth = 40;
  const std::size_t filled = done * kBarWidth / total;
  fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {:3d} %", label_, "", filled, "", kBarWidth - filled, step);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace trueblade
