// A plan's moves held against the nominal part before anything moves: the housing must keep its clearance on
// every one of them. It trusts no planner: a plan that was read, edited or made by other means is checked the
// same way.
#pragma once

#include <span>
#include <string>

#include "hardware/machine_geometry.h"
#include "hardware/scan_plan.h"

namespace trueblade {

// How far along the beam (a coordinate in `stage`, mm) the probe origin may go while the table turns: before
// everything that the turning part sweeps, less the clearance. The same for all rotary angles.
double turning_limit_mm(const MachineGeometry& geometry, const FacetModel& nominal,
                        const RigidTransform& mcs_from_part, double clearance_mm);

// Follows the plan from `start` (where the machine stands before) to the end of its retreat. A move at a
// standing table is straight; while the table turns, the probe must be before the turning limit. `clearance`
// is of the nominal model with `body`. Throws InputError naming the view, the move and what it would touch.
void check_clearance(const ScanPlan& plan, const MachineGeometry& geometry, const FacetModel& nominal,
                     const RigidTransform& part_from_mcs, const ProbeClearance& clearance,
                     const ProbeBody& body, const AxisPositions& start);

// The same of the way on which the machine, from where it really stands, comes to its first line or back to
// where a scan broke off (ExecutionOptions::check_first_way).
void check_first_way(const std::string& view, const MachineGeometry& geometry, const FacetModel& nominal,
                     const RigidTransform& part_from_mcs, const ProbeClearance& clearance,
                     const ProbeBody& body, const AxisPositions& start, std::span<const AxisPositions> way);

}  // namespace trueblade
