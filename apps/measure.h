// Measuring a scenario: plan each view, carry it out on the scenario's backend. The one place that knows
// which backend runs.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "apps/scenario.h"
#include "geometry/ray_caster.h"
#include "hardware/machine_driver.h"
#include "hardware/scan_plan.h"
#include "part/part.h"
#include "sim/simulated_machine.h"

namespace trueblade {

// A part and the ray caster on its facet model, as planning, the virtual laser and the picture share them.
struct PartOnMachine {
  std::shared_ptr<const Part> part;
  std::shared_ptr<const RayCaster> caster;
};
PartOnMachine put_on_machine(Part part);

// What stands on the virtual machine, and the machine itself, as the scenario says.
VirtualPart virtual_part(const Scenario& scenario, const PartOnMachine& nominal);
VirtualSetup virtual_setup(const Scenario& scenario);

struct MeasuredView {
  ViewScan scan;
  std::size_t planned = 0;
  std::optional<RigidTransform> true_part_from_mcs;  // in simulation
};

// Where the samples are kept as they are measured (hardware/recorded/journal.h).
struct JournalSpec {
  std::filesystem::path file;
  // Go on with the scan in the file, if there is one: what it holds is not measured again. Otherwise a scan
  // in the file that is not complete is kept beside it, as <file>.old, and a new journal begins.
  bool resume = false;
};

class Measurement {
 public:
  // Throws InputError when the set-up is not valid, or the journal to be resumed cannot be read.
  Measurement(const Scenario& scenario, const PartOnMachine& nominal,
              const std::optional<JournalSpec>& journal = std::nullopt);
  ~Measurement();

  // Shows its progress on standard error. Ctrl-C ends it early: then scan.complete is false.
  // Throws InputError (the plan; the journal holds another one), MachineFault.
  MeasuredView measure(const ViewSpec& view);

 private:
  struct Session;
  std::vector<ProbeSample> measured_before(const ScanPlan& plan);

  const Scenario& scenario_;
  PartOnMachine nominal_;
  std::unique_ptr<Session> session_;
};

}  // namespace trueblade
