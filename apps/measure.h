// Measuring a scenario on its backend. The one place that knows which backend runs.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/plan_scan.h"
#include "hardware/machine_driver.h"
#include "hardware/scan_plan.h"

namespace trueblade {

// What only a simulation knows of a view.
struct MeasuredTruth {
  RigidTransform part_from_mcs;
  std::vector<double> deviation_mm;  // of the true part from the nominal one, per point of the scan
};

struct MeasuredView {
  ViewScan scan;
  std::size_t planned = 0;
  std::optional<MeasuredTruth> truth;  // in simulation
};

class Measurement {
 public:
  // Plans every view, so that whatever is wrong with one is known before anything moves. Throws InputError.
  Measurement(const Scenario& scenario, const PartOnMachine& nominal);
  ~Measurement();

  const std::vector<ScanPlan>& plans() const { return plans_; }

  // Shows its progress on standard error. Ctrl-C ends it early: then scan.complete is false.
  // Throws InputError when nothing came back, MachineFault.
  MeasuredView measure(const ScanPlan& plan);

 private:
  struct Backend;
  const Scenario& scenario_;
  std::vector<ScanPlan> plans_;
  std::unique_ptr<Backend> backend_;
};

}  // namespace trueblade
