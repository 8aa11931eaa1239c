// Carries out a scan plan through a driver: the same for every backend.
#pragma once

#include <cstddef>
#include <functional>

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

// Connects and homes the machine where that is not yet done, checks the whole plan against its travel limits,
// and only then moves. Samples become points in the MCS by the nominal `geometry`.
// Throws InputError (plan outside the limits, nothing has moved) or MachineFault (motion has been stopped).
ViewScan execute_plan(MachineDriver& driver, const MachineGeometry& geometry, const ScanPlan& plan,
                      const ScanProgress& progress = {});

}  // namespace trueblade
