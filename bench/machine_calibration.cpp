// The calibration by a reference sphere against the truth of the virtual machine, for
// results/linuxcnc/calibration.md:
//
//   build/release/bench/machine_calibration scenarios/calibration_sphere.yaml >
//   results/linuxcnc/calibration.md
//
// In every trial the errors of the machine are drawn anew, the sphere is measured through the driver with the
// whole sensor model, and what the calibration finds is compared with what was drawn.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "apps/measure.h"
#include "calibration/sphere_calibration.h"
#include "sim/true_geometry.h"

namespace {

using namespace trueblade;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kTrials = 100;

struct Case {
  const char* words;
  Lens lens;
  double spread_mm;
  double beam_deg, place_mm, axis_deg;  // standard deviations of what is to be found
  double stage_mm;                      // positioning and straightness, one draw a line
};

Scenario scenario_of(Scenario scenario, const Case& c, int trial) {
  scenario.trial = static_cast<std::uint64_t>(trial);
  scenario.machine.lens = c.lens;
  scenario.scan.standoff_spread_mm = c.spread_mm;
  MachineErrors& errors = scenario.machine.simulation.errors;
  using enum ErrorSource;
  errors[beam_a].sigma = errors[beam_b].sigma = c.beam_deg * kDegree;
  errors[xoc].sigma = errors[yoc].sigma = c.place_mm;
  errors[aoc].sigma = errors[boc].sigma = c.axis_deg * kDegree;
  for (const ErrorSource source : {exx, eyx, ezx, exy, eyy, ezy, exz, eyz, ezz})
    errors[source] = {0.0, c.stage_mm, ErrorScope::line, 0};
  return scenario;
}

struct Trial {
  SphereCalibration found;
  SphereStep error;
};

Trial run(const Scenario& scenario, const PartOnMachine& nominal) {
  Measurement measurement(scenario, nominal);
  std::vector<ProbeSample> samples;
  for (const ScanPlan& plan : measurement.plans()) {
    const std::vector<ProbeSample> of_view = measurement.measure(plan).scan.samples;
    samples.insert(samples.end(), of_view.begin(), of_view.end());
  }
  const MachineSpec& machine = scenario.machine;
  const Vec3 centre_mm = machine.mcs_from_part.translation_mm;
  const ReferenceSphere sphere{0.5 * scenario.part.reference_sphere.diameter_mm, centre_mm};
  Trial trial{calibrate_by_sphere(machine.geometry, machine.lens.standoff_mm, sphere, samples), {}};
  ErrorValues drawn;
  draw_errors(machine.simulation.errors, ErrorScope::setup, scenario.seed, scenario.trial, 0, drawn);
  trial.error = sphere_step(true_geometry(machine.geometry, drawn), centre_mm, trial.found.geometry,
                            trial.found.centre_mcs_mm, machine.lens.standoff_mm);
  return trial;
}

void report(const Scenario& base, const PartOnMachine& nominal, const Case& c) {
  SphereStep squares = SphereStep::Zero(), stated = SphereStep::Zero();
  double chi_square = 0.0, sigma = 0.0;
  std::size_t used = 0, off_sphere = 0;
  for (int k = 0; k < kTrials; ++k) {
    const Trial trial = run(scenario_of(base, c, k), nominal);
    squares += trial.error.cwiseAbs2();
    stated += trial.found.covariance.diagonal();
    chi_square += trial.error.dot(trial.found.covariance.ldlt().solve(trial.error));
    sigma += trial.found.sigma_mm;
    used += trial.found.used;
    off_sphere += trial.found.off_sphere;
  }
  const SphereStep rms = (squares / kTrials).cwiseSqrt();
  const SphereStep u = (stated / kTrials).cwiseSqrt();
  const auto pair = [&](const SphereStep& of, SphereParameter first) {
    return std::sqrt(0.5 * (of[first] * of[first] + of[first + 1] * of[first + 1]));
  };
  fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.0f} / {:.0f} | {:.1f} / {:.1f} | {:.2f} / {:.2f} | {:.2f} |\n",
             c.words, used / kTrials,
             100.0 * static_cast<double>(off_sphere) / static_cast<double>(used + off_sphere),
             1e3 * sigma / kTrials, 1e6 * pair(rms, beam_tilt_1), 1e6 * pair(u, beam_tilt_1),
             1e6 * pair(rms, axis_tilt_1), 1e6 * pair(u, axis_tilt_1), 1e3 * pair(rms, axis_shift_1),
             1e3 * pair(u, axis_shift_1), chi_square / kTrials / kSphereParameters);
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    fmt::print(stderr, "usage: machine_calibration scenarios/calibration_sphere.yaml\n");
    return 2;
  }
  const Scenario scenario = read_scenario(arguments[1]);
  const PartOnMachine nominal = put_on_machine(make_part(scenario.part));
  const Lens fine = standard_lens("25mm");
  fmt::print(
      "# Calibration by a reference sphere\n\n"
      "    build/release/bench/machine_calibration scenarios/calibration_sphere.yaml > "
      "results/linuxcnc/calibration.md\n\n"
      "A sphere of 25 mm stands 40 mm beside the rotary axis and is measured at eight rotary angles "
      "(docs/linuxcnc.md). "
      "{} trials a row, each\nwith errors of the machine drawn anew; what was found against what was drawn: "
      "root mean "
      "square error / stated standard uncertainty. The\nlast column is the mean of chi square over its nine "
      "degrees of "
      "freedom: 1 where the stated covariance is right (standard error {:.2f}).\n\n"
      "| lens, errors to be found, errors that are not calibrated | samples | off sphere % | sigma um | beam "
      "urad | axis "
      "urad | place of the axis um | chi square |\n|---|---|---|---|---|---|---|---|\n",
      kTrials, std::sqrt(2.0 / kSphereParameters / kTrials));
  for (const Case& c :
       {Case{"50 mm lens; 0.3 deg, 0.3 mm, 0.05 deg; none", scenario.machine.lens,
             scenario.scan.standoff_spread_mm, 0.3, 0.3, 0.05, 0.0},
        Case{"25 mm lens; 0.02 deg, 0.01 mm, 0.002 deg; none", fine, 0.2, 0.02, 0.01, 0.002, 0.0},
        Case{"25 mm lens, the same; stages 1 um a line", fine, 0.2, 0.02, 0.01, 0.002, 0.001}})
    report(scenario, nominal, c);
}
