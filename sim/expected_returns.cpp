#include "sim/expected_returns.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trueblade {

ExpectedReturns expected_returns(const ScanPlan& plan, const SensorModel& model, const Lens& lens) {
  const double least_cosine = std::cos(lens.max_incidence_rad);
  ExpectedReturns returns;
  returns.points = plan.points.size();
  for (const PlannedPoint& point : plan.points) {
    if (point.incidence_cosine < least_cosine) {
      ++returns.beyond_incidence;
      continue;
    }
    const double signal = mean_signal(model, lens, point.range_mm - lens.standoff_mm, point.incidence_cosine);
    const double snr = signal_to_noise(model, signal);
    returns.best_snr = std::max(returns.best_snr, snr);
    if (signal <= 0.0 || snr < model.missed_snr) ++returns.too_weak;
  }
  return returns;
}

std::string missing_returns(const ExpectedReturns& returns, const SensorModel& model, const Lens& lens) {
  if (returns.returning() == returns.points) return "";
  std::string reasons;
  if (returns.too_weak > 0)
    reasons +=
        fmt::format("{} with an SNR below missed_snr ({}) by finish, incidence and noise_to_signal ({})",
                    returns.too_weak, model.missed_snr, model.noise_to_signal);
  if (returns.beyond_incidence > 0)
    reasons += fmt::format("{}{} beyond the lens's incidence of {:.1f} deg", reasons.empty() ? "" : ", ",
                           returns.beyond_incidence, lens.max_incidence_rad * 180.0 / std::numbers::pi);
  return fmt::format("{} of {} planned points would send no light back: {}",
                     returns.points - returns.returning(), returns.points, reasons);
}

}  // namespace trueblade
