// Carries out a scan plan through a driver: the same for every backend.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "hardware/machine_driver.h"
#include "hardware/machine_geometry.h"
#include "hardware/scan_plan.h"

namespace trueblade {

// Throws InputError naming the view, line, axis, value and limits of the first planned position that the
// machine cannot reach.
void check_travel(const ScanPlan& plan, const AxisLimits& limits);

// Called after every sample with the number taken and planned. Returning false interrupts the scan: the
// machine is stopped, and what was measured is kept.
using ScanProgress = std::function<bool(std::size_t taken, std::size_t planned)>;

struct ExecutionOptions {
  ScanProgress progress;
  // Samples of this very plan that an earlier run took, in order: they are not measured again. The machine
  // goes to where the scan broke off and advances along the beam again.
  std::vector<ProbeSample> measured_before;
  // Called before the first move with where the machine stands and the positions it is about to move through
  // to its first line; what it throws ends the execution, and nothing has moved.
  std::function<void(const AxisPositions& from, std::span<const AxisPositions> way)> check_first_way;
  // Called with every new sample before anything else is done with it. What it throws stops the machine.
  std::function<void(const ProbeSample&)> keep;
  // Whether somebody wants the scan to end. A driver that was asked too (LinuxCncMachine::stop_when) breaks
  // off its motion with a MachineFault (interrupted), which is then no fault: what was measured is kept.
  std::function<bool()> stop_asked;
};

// Connects and homes the machine where that is not yet done, checks the whole plan against its travel limits,
// and only then moves. From wherever it stands it first withdraws the probe along the beam to the depth of
// the plan's retreat. Samples become points in the MCS by the nominal `geometry`. Throws InputError (plan
// outside the limits, or more samples measured before than planned; nothing has moved) or MachineFault
// (motion has been stopped).
ViewScan execute_plan(MachineDriver& driver, const MachineGeometry& geometry, const ScanPlan& plan,
                      const ExecutionOptions& options = {});

}  // namespace trueblade
