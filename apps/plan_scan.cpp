#include "apps/plan_scan.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <set>

#include "hardware/check_clearance.h"
#include "hardware/execute_plan.h"
#include "sim/expected_returns.h"

namespace trueblade {
namespace {

PlanOptions plan_options(const Scenario& scenario) {
  PlanOptions options;
  options.spacing_mm = scenario.scan.spacing_mm;
  options.standoff_spread_mm = scenario.scan.standoff_spread_mm;
  options.surfaces = scenario.scan.surfaces;
  options.max_incidence_rad = scenario.scan.max_incidence_rad;
  options.probe = scenario.machine.probe;
  return options;
}

ViewChoice choose_angles(const Scenario& scenario, const PartOnMachine& nominal) {
  const MachineSpec& machine = scenario.machine;
  return choose_view_angles(machine.geometry, machine.lens, machine.limits, *nominal.part, *nominal.caster,
                            machine.mcs_from_part.inverse(), plan_options(scenario),
                            *scenario.scan.automatic_views);
}

// theta_120, or theta_7.5 as theta_7p5: a name of files.
std::string name_of_angle(double theta_rad) {
  std::string name = fmt::format("theta_{:g}", std::round(theta_rad * 1800.0 / std::numbers::pi) / 10.0);
  for (char& letter : name)
    if (letter == '.') letter = 'p';
  return name;
}

std::vector<ViewSpec> named_views(const std::vector<double>& theta_rad) {
  std::vector<ViewSpec> views;
  for (const double theta : theta_rad) views.push_back({name_of_angle(theta), theta});
  return views;
}

const AxisPositions& last_position(const ScanPlan& plan) {
  return plan.retreat.empty() ? plan.lines.back().path.back() : plan.retreat.back();
}

// A view that sees nothing is a failure of that view; a scan that sees nothing is a mistake of the scenario.
void require_a_view(const std::vector<ViewSpec>& views, const UnseenViews& unseen) {
  if (unseen.size() < views.size()) return;
  std::string reasons;
  for (const ViewSpec& view : views) reasons += (reasons.empty() ? "" : "; ") + unseen.at(view.name);
  throw InputError(reasons);
}

bool sensor_is_simulated(const MachineSpec& machine) {
  return machine.backend == "simulated";
}

void require_a_return(const MachineSpec& machine, const ScanPlan& plan) {
  if (!sensor_is_simulated(machine)) return;
  const ExpectedReturns returns = expected_returns(plan, machine.simulation.sensor, machine.lens);
  if (returns.returning() > 0) return;
  throw NothingToMeasure(
      fmt::format("view {}: the beam would never return: {}; the best SNR is {:.3g}", plan.view,
                  missing_returns(returns, machine.simulation.sensor, machine.lens), returns.best_snr));
}

}  // namespace

PartOnMachine put_on_machine(Part part) {
  auto shared = std::make_shared<const Part>(std::move(part));
  auto caster = std::make_shared<const RayCaster>(shared->model);
  return {std::move(shared), std::move(caster)};
}

ViewsWithCoverage choose_and_cover(const Scenario& scenario, const PartOnMachine& nominal) {
  const MachineSpec& machine = scenario.machine;
  if (scenario.scan.automatic_views) {
    ViewChoice choice = choose_angles(scenario, nominal);
    return {named_views(choice.theta_rad), std::move(choice.coverage), choice.coverable};
  }
  std::vector<double> theta_rad;
  for (const ViewSpec& view : scenario.scan.views) theta_rad.push_back(view.theta_rad);
  return {scenario.scan.views,
          coverage_of_views(machine.geometry, machine.lens, *nominal.part, *nominal.caster,
                            machine.mcs_from_part.inverse(), plan_options(scenario), theta_rad,
                            ViewAngleOptions().sample_count),
          std::nullopt};
}

std::vector<ViewSpec> views_of(const Scenario& scenario, const PartOnMachine& nominal) {
  if (!scenario.scan.automatic_views) return scenario.scan.views;
  return named_views(choose_angles(scenario, nominal).theta_rad);
}

std::vector<ScanPlan> plan_views(const Scenario& scenario, const PartOnMachine& nominal,
                                 const std::vector<ViewSpec>& views, UnseenViews* unseen) {
  const MachineSpec& machine = scenario.machine;
  const RigidTransform part_from_mcs = machine.mcs_from_part.inverse();
  const ProbeClearance clearance(nominal.part->model, machine.probe);
  std::vector<ScanPlan> plans;
  AxisPositions at;  // home
  for (const ViewSpec& view : views) {
    PlanOptions options = plan_options(scenario);
    options.view = view.name;
    options.theta_rad = view.theta_rad;
    try {
      ScanPlan plan =
          plan_view(machine.geometry, machine.lens, *nominal.part, *nominal.caster, part_from_mcs, options);
      require_a_return(machine, plan);
      plans.push_back(std::move(plan));
    } catch (const NothingToMeasure& nothing) {
      if (!unseen) throw;
      unseen->emplace(view.name, nothing.what());
      plans.emplace_back();
      plans.back().view = view.name;
      plans.back().theta_rad = view.theta_rad;
      continue;
    }
    check_travel(plans.back(), machine.limits);
    check_clearance(plans.back(), machine.geometry, nominal.part->model, part_from_mcs, clearance,
                    machine.probe, at);
    at = last_position(plans.back());
  }
  if (unseen) require_a_view(views, *unseen);
  return plans;
}

std::string missing_returns(const MachineSpec& machine, const ScanPlan& plan) {
  if (!sensor_is_simulated(machine)) return "";
  const SensorModel& sensor = machine.simulation.sensor;
  return missing_returns(expected_returns(plan, sensor, machine.lens), sensor, machine.lens);
}

std::vector<std::uint32_t> surfaces_between_points(const Coverage& coverage,
                                                   const std::vector<ScanPlan>& plans) {
  std::set<std::uint32_t> planned;
  for (const ScanPlan& plan : plans)
    for (const PlannedPoint& point : plan.points) planned.insert(point.surface);
  std::vector<std::uint32_t> missed;
  for (const SurfaceCoverage& surface : coverage.surfaces)
    if (surface.seen > 0.0 && !planned.contains(surface.surface)) missed.push_back(surface.surface);
  return missed;
}

std::vector<double> estimated_times_s(const MachineSpec& machine, const std::vector<ScanPlan>& plans) {
  std::vector<double> times_s;
  AxisPositions at;  // home
  for (const ScanPlan& plan : plans) {
    if (plan.lines.empty()) {
      times_s.push_back(0.0);
      continue;
    }
    times_s.push_back(estimated_time_s(plan, machine.dynamics, machine.lens, at));
    at = last_position(plan);
  }
  return times_s;
}

}  // namespace trueblade
