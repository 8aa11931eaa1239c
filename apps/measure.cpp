#include "apps/measure.h"

#include <fmt/format.h>

#include "apps/console.h"
#include "apps/interrupt.h"
#include "hardware/execute_plan.h"
#include "sim/simulated_machine.h"

namespace trueblade {

namespace {

VirtualSetup virtual_setup(const Scenario& scenario) {
  const MachineSpec& machine = scenario.machine;
  VirtualSetup setup;
  setup.geometry = machine.geometry;
  setup.limits = machine.limits;
  setup.dynamics = machine.dynamics;
  setup.lens = machine.lens;
  setup.part_from_mcs = machine.mcs_from_part.inverse();
  setup.mcs_from_fixture = machine.mcs_from_fixture;
  setup.errors = machine.simulation.errors;
  setup.sensor = machine.simulation.sensor;
  setup.seed = scenario.seed;
  return setup;
}

VirtualPart virtual_part(const Scenario& scenario, const PartOnMachine& nominal) {
  const SimulationSpec& simulation = scenario.machine.simulation;
  const PartSurfaceMode finest = nominal.part->exact ? PartSurfaceMode::exact : PartSurfaceMode::facets;
  constexpr std::uint64_t kTrial = 0;  // an inspection is the first trial of a study of the same scenario
  return make_virtual_part(nominal.part, nominal.caster, simulation.part_surface.value_or(finest),
                           simulation.form_errors, scenario.seed, kTrial);
}

MeasuredTruth truth_of(const SimulationTruth& simulated, const ViewScan& scan) {
  MeasuredTruth truth;
  truth.part_from_mcs = simulated.part_from_mcs;
  for (const std::uint32_t sample : scan.usable)  // a usable sample has met the part
    truth.deviation_mm.push_back(simulated.hits[sample]->deviation_mm);
  return truth;
}

// A scan that follows its plan blindly may miss the part altogether.
void require_points(const ViewScan& scan) {
  if (!scan.usable.empty()) return;
  std::size_t out_of_range = 0;
  for (const ProbeSample& sample : scan.samples) out_of_range += sample.flags.out_of_range ? 1 : 0;
  throw InputError(
      fmt::format("view {}: none of {} samples gave a point ({} out of the working range, {} without a "
                  "return); does the part "
                  "stand where mcs_from_part says?",
                  scan.view, scan.samples.size(), out_of_range, scan.samples.size() - out_of_range));
}

}  // namespace

struct Measurement::Backend {
  SimulatedMachine machine;
};

Measurement::Measurement(const Scenario& scenario, const PartOnMachine& nominal)
    : scenario_(scenario),
      plans_(plan_views(scenario, nominal, views_of(scenario, nominal))),
      backend_(new Backend{SimulatedMachine(virtual_part(scenario, nominal), virtual_setup(scenario))}) {}

Measurement::~Measurement() = default;

MeasuredView Measurement::measure(const ScanPlan& plan) {
  Progress progress("scan " + plan.view);
  MeasuredView measured;
  measured.planned = plan.point_count();
  measured.scan = execute_plan(backend_->machine, scenario_.machine.geometry, plan,
                               [&](std::size_t taken, std::size_t planned) {
                                 progress.report(taken, planned);
                                 return !interrupted();
                               });
  measured.truth = truth_of(backend_->machine.take_truth(), measured.scan);
  if (measured.scan.complete) require_points(measured.scan);
  return measured;
}

}  // namespace trueblade
