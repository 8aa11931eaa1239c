// Measuring a scenario: plan each view, carry it out on the scenario's backend. The one place that knows
// which backend runs.
#pragma once

#include <memory>
#include <optional>

#include "apps/scenario.h"
#include "geometry/ray_caster.h"
#include "hardware/machine_driver.h"
#include "hardware/scan_plan.h"
#include "part/part.h"

namespace trueblade {

// A part and the ray caster on its facet model, as planning, the virtual laser and the picture share them.
struct PartOnMachine {
  std::shared_ptr<const Part> part;
  std::shared_ptr<const RayCaster> caster;
};
PartOnMachine put_on_machine(Part part);

struct MeasuredView {
  ViewScan scan;
  std::size_t planned = 0;
  std::optional<RigidTransform> true_part_from_mcs;  // in simulation
};

class Measurement {
 public:
  // Throws InputError when the set-up is not valid.
  Measurement(const Scenario& scenario, const PartOnMachine& nominal);
  ~Measurement();

  // Shows its progress on standard error. Ctrl-C ends it early: then scan.complete is false.
  // Throws InputError (the plan), MachineFault.
  MeasuredView measure(const ViewSpec& view);

 private:
  struct Backend;
  const Scenario& scenario_;
  PartOnMachine nominal_;
  std::unique_ptr<Backend> backend_;
};

}  // namespace trueblade
