// Measuring a scenario on its backend. The one place that knows which backend runs.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/plan_scan.h"
#include "hardware/machine_driver.h"
#include "hardware/scan_plan.h"
#include "sim/simulated_machine.h"

namespace trueblade {

// What only a simulation knows of a view.
struct MeasuredTruth {
  RigidTransform part_from_mcs;
  std::vector<double> deviation_mm;  // of the true part from the nominal one, per point of the scan
};

// What stands on the virtual machine, and the machine itself, as the scenario says.
VirtualPart virtual_part(const Scenario& scenario, const PartOnMachine& nominal);
VirtualSetup virtual_setup(const Scenario& scenario);

// What to say of a scan that gave no point at all; empty: it gave some.
std::string nothing_measured(const ViewScan& scan);

struct MeasuredView {
  ViewScan scan;
  std::size_t planned = 0;
  std::optional<MeasuredTruth> truth;  // in simulation
};

class Measurement {
 public:
  // Plans every view, so that whatever is wrong with one is known before anything moves or is written.
  // `keep_unseen`: a view that can see none of the chosen surfaces keeps an empty plan, as long as another
  // can. Throws InputError.
  Measurement(const Scenario& scenario, const PartOnMachine& nominal, bool keep_unseen = false);
  ~Measurement();

  // From here on the samples are kept in `file` as they are measured (hardware/recorded/journal.h). `resume`:
  // go on with the scan in the file, if there is one: what it holds is not measured again. Otherwise a scan
  // in the file is kept beside it, as <file>.old, .old2 ..., unless it is complete and simulated, and a new
  // journal begins. Throws InputError, also when the journal to be resumed cannot be read.
  void keep_journal(const std::filesystem::path& file, bool resume);

  const std::vector<ScanPlan>& plans() const { return plans_; }

  // Shows its progress on standard error. Ctrl-C ends it early: then scan.complete is false.
  // Throws InputError (nothing came back; the plan is empty; the journal holds another plan; on its way from
  // where the machine stands the probe would touch the part), MachineFault.
  MeasuredView measure(const ScanPlan& plan);

 private:
  struct Session;
  std::vector<ProbeSample> measured_before(const ScanPlan& plan);

  const Scenario& scenario_;
  UnseenViews unseen_;
  std::vector<ScanPlan> plans_;
  std::unique_ptr<Session> session_;
};

}  // namespace trueblade
