// The demonstration blade on the virtual machine, as the benchmarks of the virtual machine share it.
#pragma once

#include <memory>
#include <numbers>

#include "hardware/execute_plan.h"
#include "hardware/plan_view.h"
#include "part/demonstration_parts.h"
#include "registration/register_scan.h"
#include "sim/simulated_machine.h"

namespace trueblade::bench {

struct Blade {
  std::shared_ptr<const Part> part;
  std::shared_ptr<const RayCaster> caster;
};

inline Blade demonstration_blade(double chord_tolerance_mm) {
  FacetingOptions faceting;
  faceting.chord_tolerance_mm = chord_tolerance_mm;
  auto part = std::make_shared<const Part>(make_turbine_blade({}, faceting));
  auto caster = std::make_shared<const RayCaster>(part->model);
  return {std::move(part), std::move(caster)};
}

// The root stands on the table, 32 mm below the platform; the 25 mm lens looks along -y.
inline VirtualSetup blade_setup() {
  VirtualSetup setup;
  setup.lens = standard_lens("25mm");
  setup.part_from_mcs.translation_mm = {0.0, 0.0, -32.0};
  setup.mcs_from_fixture.translation_mm = {0.0, 0.0, 32.0};
  setup.geometry.stage_from_probe_at_zero.translation_mm = {0.0, 120.0, 60.0};
  setup.seed = 1;
  return setup;
}

// Shift and rotation of the fixture in all six components.
inline void set_fixture_error(MachineErrors& errors, double sigma_mm, double sigma_rad) {
  using enum ErrorSource;
  for (const ErrorSource source : {fixture_x, fixture_y, fixture_z}) errors[source].sigma = sigma_mm;
  for (const ErrorSource source : {fixture_a, fixture_b, fixture_c}) errors[source].sigma = sigma_rad;
}

struct MeasuredBlade {
  ViewScan scan;
  SimulationTruth truth;
};

inline MeasuredBlade measure(const Blade& nominal, const VirtualPart& part, const VirtualSetup& setup,
                             const PlanOptions& options) {
  const ScanPlan plan =
      plan_view(setup.geometry, setup.lens, *nominal.part, *nominal.caster, setup.part_from_mcs, options);
  SimulatedMachine machine(part, setup);
  MeasuredBlade measured;
  measured.scan = execute_plan(machine, setup.geometry, plan);
  measured.truth = machine.take_truth();
  return measured;
}

}  // namespace trueblade::bench
