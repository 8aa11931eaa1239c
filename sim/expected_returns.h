// Whether the light of a plan's points would come back, by the mean signal of the sensor model: known before
// anything moves.
#pragma once

#include <string>

#include "hardware/scan_plan.h"
#include "sim/sensor_model.h"

namespace trueblade {

struct ExpectedReturns {
  std::size_t points = 0;            // planned
  std::size_t beyond_incidence = 0;  // of these, beyond the lens's largest incidence
  std::size_t too_weak = 0;          // and with an SNR below missed_snr
  double best_snr = 0.0;             // of those within the incidence
  std::size_t returning() const { return points - beyond_incidence - too_weak; }
};

// Of the nominal part at the planned ranges and incidences, without speckle.
ExpectedReturns expected_returns(const ScanPlan& plan, const SensorModel& model, const Lens& lens);

// "3 of 50 planned points would send no light back: ..." with the reasons; empty: all of them return.
std::string missing_returns(const ExpectedReturns& returns, const SensorModel& model, const Lens& lens);

}  // namespace trueblade
