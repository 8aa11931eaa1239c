// Does weighting by SNR help? The same scans registered with and without SNR weights; the sensor's noise
// depends on incidence, place in the range and speckle, and its SNR knows it.
//
//   build/release/bench/sim_snr_weights [TRIALS] > results/sim/snr_weights.md
#include <fmt/core.h>

#include <cstdlib>

#include "bench/sim_scene.h"

int main(int argc, char** argv) {
  using namespace trueblade;
  const int trials = argc > 1 ? std::atoi(argv[1]) : 200;
  fmt::print(
      "# Pose error with and without SNR weights\n\nMade by `build/release/bench/sim_snr_weights {} > "
      "results/sim/snr_weights.md`.\n\nFront view of the "
      "demonstration blade at 1.5 mm, 25 mm lens, fixture error of 0.1 mm\nand 0.1 degrees; {} trials, each "
      "scan "
      "registered with both. Pose error: root mean square over the trials of the\nmean displacement of the "
      "scan's "
      "points by the pose's error.\n\n"
      "| surface | uniform weights um | SNR weights um | SNR weights, share | better in "
      "|\n|---|---|---|---|---|\n",
      trials, trials);
  const bench::Blade blade = bench::demonstration_blade(0.01);
  const RegistrationTarget target(*blade.part);
  // The beam meets the surfaces that the registration ends on: what is left is the noise.
  const VirtualPart part = make_virtual_part(blade.part, blade.caster, PartSurfaceMode::exact, {}, 0, 0);
  const std::pair<const char*, SurfaceFinish> finishes[] = {
      {"matt", matt_finish()}, {"ground", ground_finish()}, {"polished", polished_finish()}};
  for (const auto& [name, finish] : finishes) {
    VirtualSetup setup = bench::blade_setup();
    setup.sensor.finish = finish;
    bench::set_fixture_error(setup.errors, 0.1, 0.1 * std::numbers::pi / 180.0);
    PlanOptions options;
    options.spacing_mm = 1.5;
    const ScanPlan plan =
        plan_view(setup.geometry, setup.lens, *blade.part, *blade.caster, setup.part_from_mcs, options);
    double square[2] = {0.0, 0.0};
    int better = 0;
    for (int trial = 0; trial < trials; ++trial) {
      setup.trial = static_cast<std::uint64_t>(trial);
      SimulatedMachine machine(part, setup);
      const ViewScan scan = execute_plan(machine, setup.geometry, plan);
      const RigidTransform truth = machine.take_truth().part_from_mcs;
      double error[2];
      for (const bool weighted : {false, true}) {
        RegistrationOptions registration = preset("default");
        registration.weights.source = weighted ? WeightSource::snr : WeightSource::uniform;
        const RigidTransform found =
            register_scan(target, scan.points, setup.part_from_mcs, registration).part_from_mcs;
        double sum = 0.0;
        for (const Vec3& p : scan.points.position_mcs_mm) sum += (found * p - truth * p).squaredNorm();
        error[weighted] = sum / static_cast<double>(scan.points.size());
        square[weighted] += error[weighted];
      }
      better += error[1] < error[0] ? 1 : 0;
    }
    const double uniform_um = 1000.0 * std::sqrt(square[0] / trials),
                 snr_um = 1000.0 * std::sqrt(square[1] / trials);
    fmt::print("| {} | {:.3f} | {:.3f} | {:.2f} | {} of {} |\n", name, uniform_um, snr_um,
               snr_um / uniform_um, better, trials);
  }
  return 0;
}
