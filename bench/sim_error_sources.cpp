// Each error source alone over 10,000 points of a plane, through the whole virtual measurement: what comes
// back against its closed form. Prints a table; exits with 1 when a source is off by more than 4 standard
// errors.
//
//   build/release/bench/sim_error_sources > results/sim/error_sources.md
#include <fmt/core.h>

#include "tests/sim/error_effects.h"

int main() {
  using namespace trueblade;
  constexpr std::size_t kPoints = 10'000;
  fmt::print("# Each error source alone: observed against its closed form\n\n");
  fmt::print(
      "Made by `build/release/bench/sim_error_sources > results/sim/error_sources.md`.\n\nOne source at a "
      "time is drawn for each of 10,000 points on a tilted "
      "plane;\neverything else is perfect. The value of the source is recovered from the reported points "
      "through its closed\nform (shift along its direction, angle times lever arm, ...). The last columns "
      "are the mean and the standard\ndeviation of the recovered values, in standard errors from what was "
      "put in (0 and sigma).\n\n");
  fmt::print(
      "| source | what | sigma put in | sigma recovered | mean, SE | sigma, SE "
      "|\n|---|---|---|---|---|---|\n");
  bool all_within = true;
  const testing::ErrorScene scene = testing::error_scene();
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    const double sigma = testing::usual_sigma(source);
    const auto values = testing::observed_values(scene, source, 0.0, sigma, kPoints);
    const auto n = static_cast<double>(values.size());
    double sum = 0.0, sum_of_squares = 0.0;
    for (const double value : values) {
      sum += value;
      sum_of_squares += value * value;
    }
    const double observed = std::sqrt(sum_of_squares / n);
    const double mean_errors = sum / n / (sigma / std::sqrt(n));
    const double sigma_errors = (observed - sigma) / (sigma / std::sqrt(2.0 * n));
    all_within = all_within && std::abs(mean_errors) < 4.0 && std::abs(sigma_errors) < 4.0;
    fmt::print("| {} | {} | {:.1e} {} | {:.4e} | {:+.2f} | {:+.2f} |\n", info(source).name,
               info(source).description, sigma, info(source).unit, observed, mean_errors, sigma_errors);
  }
  return all_within ? 0 : 1;
}
