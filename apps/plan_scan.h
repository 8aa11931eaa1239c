// Planning a scenario's scan: which views, where the probe goes in each. Everything that can be wrong with a
// plan is found here, before anything moves.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/scenario.h"
#include "geometry/ray_caster.h"
#include "hardware/scan_plan.h"
#include "part/part.h"

namespace trueblade {

// A part and the ray caster on its facet model, as planning, the virtual laser and the picture share them.
struct PartOnMachine {
  std::shared_ptr<const Part> part;
  std::shared_ptr<const RayCaster> caster;
};
PartOnMachine put_on_machine(Part part);

// The views, and how much of each surface they cover.
struct ViewsWithCoverage {
  std::vector<ViewSpec> views;
  Coverage coverage;
  std::optional<double> coverable;  // of automatic views: what all candidate angles together could cover
};
ViewsWithCoverage choose_and_cover(const Scenario& scenario, const PartOnMachine& nominal);

// The stated views, or those that are chosen for coverage.
std::vector<ViewSpec> views_of(const Scenario& scenario, const PartOnMachine& nominal);

// Why views have an empty plan, by their names: they can see none of the chosen surfaces.
using UnseenViews = std::map<std::string, std::string>;

// One plan a view, in order. Throws InputError naming view and cause: nothing of the chosen surfaces can be
// measured, or by the model of a simulated sensor no light would come back (with `unseen`, only where no view
// can), a position is out of travel, or the probe would touch the part on its way, from home on.
std::vector<ScanPlan> plan_views(const Scenario& scenario, const PartOnMachine& nominal,
                                 const std::vector<ViewSpec>& views, UnseenViews* unseen = nullptr);

// Of a simulated sensor: how many points of a plan would send no light back, and why; empty: all return, or
// nothing is known of the sensor.
std::string missing_returns(const MachineSpec& machine, const ScanPlan& plan);

// Surfaces that a view can see and on which yet no point is planned: the spacing is too coarse for them.
std::vector<std::uint32_t> surfaces_between_points(const Coverage& coverage,
                                                   const std::vector<ScanPlan>& plans);

// Time of each view from speeds and accelerations, with the way from the end of the view before (or home). An
// empty plan takes none.
std::vector<double> estimated_times_s(const MachineSpec& machine, const std::vector<ScanPlan>& plans);

}  // namespace trueblade
