#include "apps/measure.h"

#include "apps/console.h"
#include "apps/interrupt.h"
#include "hardware/execute_plan.h"
#include "hardware/plan_view.h"
#include "sim/simulated_machine.h"

namespace trueblade {

PartOnMachine put_on_machine(Part part) {
  auto shared = std::make_shared<const Part>(std::move(part));
  auto caster = std::make_shared<const RayCaster>(shared->model);
  return {std::move(shared), std::move(caster)};
}

namespace {

VirtualSetup virtual_setup(const Scenario& scenario) {
  const MachineSpec& machine = scenario.machine;
  VirtualSetup setup;
  setup.geometry = machine.geometry;
  setup.limits = machine.limits;
  setup.dynamics = machine.dynamics;
  setup.lens = machine.lens;
  setup.part_from_mcs = machine.mcs_from_part.inverse();
  setup.mcs_from_fixture = machine.simulation.mcs_from_fixture;
  setup.errors = machine.simulation.errors;
  setup.sensor = machine.simulation.sensor;
  setup.seed = scenario.seed;
  return setup;
}

VirtualPart virtual_part(const Scenario& scenario, const PartOnMachine& nominal) {
  const SimulationSpec& simulation = scenario.machine.simulation;
  const PartSurfaceMode finest = nominal.part->exact ? PartSurfaceMode::exact : PartSurfaceMode::facets;
  constexpr std::uint64_t kTrial = 0;  // an inspection is the first trial of a study of the same scenario
  return make_virtual_part(nominal.part, nominal.caster, simulation.surface.value_or(finest),
                           simulation.form_errors, scenario.seed, kTrial);
}

}  // namespace

struct Measurement::Backend {
  SimulatedMachine machine;
};

Measurement::Measurement(const Scenario& scenario, const PartOnMachine& nominal)
    : scenario_(scenario),
      nominal_(nominal),
      backend_(new Backend{SimulatedMachine(virtual_part(scenario, nominal), virtual_setup(scenario))}) {}

Measurement::~Measurement() = default;

MeasuredView Measurement::measure(const ViewSpec& view) {
  const MachineSpec& machine = scenario_.machine;
  PlanOptions options;
  options.view = view.name;
  options.theta_rad = view.theta_rad;
  options.spacing_mm = scenario_.scan.spacing_mm;
  options.surfaces = scenario_.scan.surfaces;
  options.max_incidence_rad = scenario_.scan.max_incidence_rad;
  options.validate(*nominal_.part);
  const ScanPlan plan = plan_view(machine.geometry, machine.lens, *nominal_.part, *nominal_.caster,
                                  machine.mcs_from_part.inverse(), options);

  Progress progress("scan " + view.name);
  MeasuredView measured;
  measured.planned = plan.point_count();
  measured.scan =
      execute_plan(backend_->machine, machine.geometry, plan, [&](std::size_t taken, std::size_t planned) {
        progress.report(taken, planned);
        return !interrupted();
      });
  measured.true_part_from_mcs = backend_->machine.take_truth().part_from_mcs;
  return measured;
}

}  // namespace trueblade
