#include "apps/calibrate_machine.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/interrupt.h"
#include "apps/measure.h"
#include "apps/on_machine.h"
#include "apps/touched_points.h"
#include "apps/yaml_writer.h"
#include "calibration/sphere_calibration.h"
#include "geometry/atomic_file.h"
#include "hardware/linuxcnc/linuxcnc_machine.h"
#include "hardware/scan_file.h"
#include "inspection/evaluation_json.h"
#include "sim/true_geometry.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kDegree = std::numbers::pi / 180.0;

// --- calibrate -------------------------------------------------------------------------------------------

struct CalibrateOptions {
  std::filesystem::path scenario;
  std::vector<std::string> scans;
  std::filesystem::path out;
  bool resume = false;
};

Scenario sphere_scenario(const std::filesystem::path& file) {
  Scenario scenario = read_scenario(file);
  if (scenario.part.demonstration != Demonstration::reference_sphere)
    throw file_error(file.string(),
                     "the part must be the reference sphere (demonstration: reference_sphere)");
  return scenario;
}

// What was measured, view after view.
struct SphereScans {
  std::vector<std::string> views;
  std::vector<std::size_t> ends;  // of each view, in `samples`
  std::vector<ProbeSample> samples;

  void add(const std::string& view, const std::vector<ProbeSample>& of_view) {
    views.push_back(view);
    samples.insert(samples.end(), of_view.begin(), of_view.end());
    ends.push_back(samples.size());
  }
};

// Fewer than all views when the user interrupts it.
SphereScans measure_sphere(const Scenario& scenario, const CalibrateOptions& options) {
  const PartOnMachine nominal = put_on_machine(make_part(scenario.part));
  Measurement measurement(scenario, nominal);
  measurement.keep_journal(std::filesystem::path(options.out).replace_extension("journal"), options.resume);
  SphereScans scans;
  for (const ScanPlan& plan : measurement.plans()) {
    scans.add(plan.view, measurement.measure(plan).scan.samples);
    if (interrupted()) break;
  }
  return scans;
}

SphereScans stored_scans(const std::vector<std::string>& files) {
  SphereScans scans;
  for (const std::string& file : files) {
    const ViewScan scan = read_scan(file);
    scans.add(scan.view, scan.samples);
  }
  return scans;
}

struct ViewCount {
  std::size_t used = 0, no_distance = 0, off_sphere = 0;
};

std::vector<ViewCount> count_views(const SphereScans& scans, const std::vector<SampleUse>& uses) {
  std::vector<ViewCount> counts(scans.views.size());
  std::size_t i = 0;
  for (std::size_t view = 0; view < counts.size(); ++view)
    for (; i < scans.ends[view]; ++i) {
      if (uses[i] == SampleUse::used) ++counts[view].used;
      if (uses[i] == SampleUse::no_distance) ++counts[view].no_distance;
      if (uses[i] == SampleUse::off_sphere) ++counts[view].off_sphere;
    }
  return counts;
}

struct ParameterRow {
  SphereParameter parameter;
  const char* name;
  const char* unit;
  const char* words;  // the direction follows
};
constexpr ParameterRow kRows[] = {{beam_tilt_1, "beam_tilt_1", "rad", "beam turned about"},
                                  {beam_tilt_2, "beam_tilt_2", "rad", "beam turned about"},
                                  {axis_tilt_1, "axis_tilt_1", "rad", "rotary axis turned about"},
                                  {axis_tilt_2, "axis_tilt_2", "rad", "rotary axis turned about"},
                                  {axis_shift_1, "axis_shift_1", "mm", "rotary axis shifted along"},
                                  {axis_shift_2, "axis_shift_2", "mm", "rotary axis shifted along"},
                                  {centre_x, "sphere_centre_x", "mm", "sphere shifted along"},
                                  {centre_y, "sphere_centre_y", "mm", "sphere shifted along"},
                                  {centre_z, "sphere_centre_z", "mm", "sphere shifted along"}};

// A direction in `stage`: an axis by its name, within the two digits of the others.
std::string direction_words(const Vec3& direction) {
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k)
    if (std::abs(direction[k]) > 0.99995)  // 10 mrad off
      return std::string(direction[k] < 0.0 ? "-" : "") + kNames[k];
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", direction.x(), direction.y(), direction.z());
}

// About or along what each parameter goes, in the order of SphereParameter.
std::array<std::string, kSphereParameters> parameter_directions(const MachineGeometry& nominal) {
  const Eigen::Matrix<double, 3, 2> beam =
      nominal.stage_from_probe_at_zero.rotation.toRotationMatrix() * beam_normals(nominal);
  const Mat3 axis = rotary_axis_normals(nominal);
  std::array<std::string, kSphereParameters> words;
  for (int k = 0; k < 2; ++k) {
    const auto at = static_cast<std::size_t>(k);
    words[beam_tilt_1 + at] = direction_words(beam.col(k));
    words[axis_tilt_1 + at] = words[axis_shift_1 + at] = direction_words(axis.col(k));
  }
  words[centre_x] = "x";
  words[centre_y] = "y";
  words[centre_z] = "z";
  return words;
}

// Found, and in simulation true: steps from the geometry that the scenario states.
struct Changes {
  SphereStep found;
  std::optional<SphereStep> truth;
};

SphereStep true_change(const Scenario& scenario) {
  const MachineSpec& machine = scenario.machine;
  ErrorValues drawn;
  draw_errors(machine.simulation.errors, ErrorScope::setup, scenario.seed, scenario.trial, 0, drawn);
  return sphere_step(
      machine.geometry, machine.mcs_from_part.translation_mm, true_geometry(machine.geometry, drawn),
      true_mcs_from_part(machine.mcs_from_part, machine.mcs_from_fixture, drawn).translation_mm,
      machine.lens.standoff_mm);
}

double standard_uncertainty(const SphereCalibration& found, SphereParameter parameter) {
  return std::sqrt(found.covariance(parameter, parameter));
}

// A machine file that holds nothing but the geometry: to be pasted, or to be referred to.
std::string machine_text(const SphereCalibration& found, const MachineGeometry& nominal) {
  const auto directions = parameter_directions(nominal);
  MachineGeometry geometry = found.geometry;
  const std::string block = yaml_text(
      [&](YamlFields& io) { io.map("geometry", [&](YamlFields& inner) { fields(inner, geometry); }); });
  std::string text = fmt::format(
      "# Geometry of the machine from {} samples of a reference sphere at {} rotary angles; a distance "
      "scatters by {:.5f} mm.\n"
      "# It takes the place of the block `geometry` in the machine file.\n"
      "# Standard uncertainties (random errors of the samples; docs/linuxcnc.md says what they leave out):\n",
      found.used, found.angles, found.sigma_mm);
  const auto pair = [&](SphereParameter first, SphereParameter second, const char* unit, const char* how) {
    return fmt::format("{:.2g} and {:.2g} {} {} {} and {}", standard_uncertainty(found, first),
                       standard_uncertainty(found, second), unit, how, directions[first], directions[second]);
  };
  text += fmt::format(
      "#   beam_direction         {}, turned about the working point\n"
      "#   rotary_axis_direction  {}\n"
      "#   rotary_axis_point_mm   {}; along the axis any point is as good\n",
      pair(beam_tilt_1, beam_tilt_2, "rad", "about"), pair(axis_tilt_1, axis_tilt_2, "rad", "about"),
      pair(axis_shift_1, axis_shift_2, "mm", "along"));
  return text +
         "# Held: the working point (mount + standoff along the beam), the axis directions, the sphere's "
         "radius.\n" +
         block;
}

Json json_of(const SphereCalibration& found, const Changes& changes, const SphereScans& scans) {
  Json json;
  json["settled"] = found.settled;
  json["passes"] = found.passes;
  json["sigma_mm"] = found.sigma_mm;
  json["rotary_angles"] = found.angles;
  json["samples"] = {{"used", found.used}, {"off_sphere", found.off_sphere}};
  const std::vector<ViewCount> counts = count_views(scans, found.uses);
  for (std::size_t view = 0; view < counts.size(); ++view)
    json["views"].push_back({{"view", scans.views[view]},
                             {"used", counts[view].used},
                             {"no_distance", counts[view].no_distance},
                             {"off_sphere", counts[view].off_sphere}});
  const MachineGeometry& g = found.geometry;
  json["geometry"] = {{"stage_from_probe_at_zero", pose_json(g.stage_from_probe_at_zero)},
                      {"beam_direction", vector_json(g.beam_direction)},
                      {"rotary_axis_point_mm", vector_json(g.rotary_axis_point_mm)},
                      {"rotary_axis_direction", vector_json(g.rotary_axis_direction)}};
  json["sphere_centre_mcs_mm"] = vector_json(found.centre_mcs_mm);
  json["axis_to_sphere_mm"] = found.axis_to_sphere_mm;
  for (const ParameterRow& row : kRows) {
    const std::string key = fmt::format("{}_{}", row.name, row.unit);
    json["change"][key] = changes.found[row.parameter];
    if (changes.truth) json["true_change"][key] = (*changes.truth)[row.parameter];
    json["standard_uncertainty"][key] = standard_uncertainty(found, row.parameter);
  }
  json["covariance"] = covariance_json(found.covariance);
  return json;
}

void print_changes(const SphereCalibration& found, const Changes& changes, const MachineGeometry& nominal) {
  const auto directions = parameter_directions(nominal);
  std::string heading = fmt::format("\n{:<32} {:>10} {:>10} {:<4}", "", "change", "u", "");
  if (changes.truth) heading += fmt::format(" {:>10} {:>10}", "true", "error / u");
  fmt::print("{}\n", heading);
  for (const ParameterRow& row : kRows) {
    const double change = changes.found[row.parameter], u = standard_uncertainty(found, row.parameter);
    std::string text =
        fmt::format("{:<32} {:>10.6f} {:>10.6f} {:<4}",
                    fmt::format("{} {}", row.words, directions[row.parameter]), change, u, row.unit);
    if (changes.truth) {
      const double truth = (*changes.truth)[row.parameter];
      text += fmt::format(" {:>10.6f} {:>10.1f}", truth, (change - truth) / u);
    }
    fmt::print("{}\n", text);
  }
  fmt::print("change: from what the scenario states, in axes of the stage; u: its standard uncertainty\n");
  if (changes.truth)
    fmt::print(
        "true: as the simulated machine was drawn, known to a simulation alone; an error of more than 3 u is "
        "no "
        "chance\n");
}

void print_calibration(const SphereCalibration& found, const Changes& changes, const MachineGeometry& nominal,
                       const SphereScans& scans) {
  fmt::print("{:<12} {:>8} {:>12} {:>11}\n", "view", "used", "no distance", "off sphere");
  const std::vector<ViewCount> counts = count_views(scans, found.uses);
  for (std::size_t view = 0; view < counts.size(); ++view)
    fmt::print("{:<12} {:>8} {:>12} {:>11}\n", scans.views[view], counts[view].used, counts[view].no_distance,
               counts[view].off_sphere);
  print_changes(found, changes, nominal);
  fmt::print("\na distance scatters by {:.5f} mm; the sphere stands {:.3f} mm from the rotary axis\n",
             found.sigma_mm, found.axis_to_sphere_mm);
}

int calibrate(const CalibrateOptions& options, bool json) {
  const Scenario scenario = sphere_scenario(options.scenario);
  create_output_folder(std::filesystem::absolute(options.out).parent_path());
  const SphereScans scans =
      options.scans.empty() ? measure_sphere(scenario, options) : stored_scans(options.scans);
  if (interrupted()) return ExitCode::interrupted_by_user;

  const MachineSpec& machine = scenario.machine;
  const ReferenceSphere sphere{0.5 * scenario.part.reference_sphere.diameter_mm,
                               machine.mcs_from_part.translation_mm};
  const SphereCalibration found =
      calibrate_by_sphere(machine.geometry, machine.lens.standoff_mm, sphere, scans.samples);
  Changes changes{sphere_step(machine.geometry, sphere.centre_mcs_mm, found.geometry, found.centre_mcs_mm,
                              machine.lens.standoff_mm),
                  std::nullopt};
  // Stored scans may be of another machine.
  if (machine.backend == "simulated" && options.scans.empty()) changes.truth = true_change(scenario);
  if (json)
    fmt::print("{}\n", json_of(found, changes, scans).dump(2));
  else
    print_calibration(found, changes, machine.geometry, scans);
  if (!found.settled) {
    spdlog::error("the fit has not settled within {} passes; nothing was written", found.passes);
    return ExitCode::expectation_failed;
  }
  write_text_atomically(options.out, machine_text(found, machine.geometry));
  if (!json)
    fmt::print(
        "geometry -> {}\n\nNext: put its block `geometry` in the place of the one in the machine file (or "
        "under "
        "`machine:` in\n"
        "the scenario); stage_from_probe_at_zero, beam_direction, rotary_axis_point_mm and "
        "rotary_axis_direction have changed.\n",
        options.out.string());
  return ExitCode::done;
}

// --- touch and locate ------------------------------------------------------------------------------------

struct TouchOptions {
  std::filesystem::path machine, points, out;
  std::string name;
  std::vector<double> part_mm;
};

int touch(const TouchOptions& options) {
  MachineSpec spec = read_machine(options.machine);
  if (spec.backend != "linuxcnc")
    throw file_error(options.machine.string(),
                     fmt::format("backend is {}, must be linuxcnc for this command", spec.backend));
  TouchFile touched;
  if (std::filesystem::exists(options.points)) touched = read_touch_file(options.points);
  TouchReading reading{options.name, Vec3(options.part_mm.data()), {}};
  on_machine(spec, [&](LinuxCncMachine& machine) { reading.sample = machine.measure_point(); });
  if (!reading.sample.flags.usable())
    throw MachineFault(MachineFault::Kind::sensor,
                       fmt::format("no distance at \"{}\": {}; nothing was written", options.name,
                                   reading.sample.flags.out_of_range ? "out of range" : "no return"));
  const Vec3 at = point_in_mcs_mm(spec.geometry, reading.sample);
  std::erase_if(touched.points, [&](const TouchReading& point) { return point.name == options.name; });
  touched.points.push_back(std::move(reading));
  write_touch_file(options.points, touched);
  fmt::print("{} at {:.4f} {:.4f} {:.4f} mm (MCS), {} points -> {}\n", options.name, at.x(), at.y(), at.z(),
             touched.points.size(), options.points.string());
  return ExitCode::done;
}

std::string location_text(const PartLocation& location, std::size_t points) {
  RigidTransform mcs_from_part = location.mcs_from_part;
  const Vec6 u = location.covariance.diagonal().cwiseSqrt();
  return fmt::format(
             "# Where the part stands, from {} touched points; they miss each other by {:.3f} mm (root mean "
             "square).\n"
             "# Standard uncertainties: {:.4f} {:.4f} {:.4f} deg about x, y, z of the MCS; {:.4f} mm of the "
             "mean of "
             "the points.\n",
             points, location.rms_mm, u[0] / kDegree, u[1] / kDegree, u[2] / kDegree, u[3]) +
         yaml_text([&](YamlFields& io) { io.pose("mcs_from_part", mcs_from_part); });
}

int locate(const TouchOptions& options, bool json) {
  const MachineSpec spec = read_machine(options.machine);
  const TouchFile touched = read_touch_file(options.points);
  const std::vector<TouchedPoint> points = touched_points(touched, spec.geometry);
  PartLocation location;
  try {
    location = locate_part(points, touched.sigma_mm);
  } catch (const InputError& error) {
    throw file_error(options.points.string(), error.what());
  }
  if (!options.out.empty()) write_text_atomically(options.out, location_text(location, points.size()));
  if (json) {
    Json document = {{"mcs_from_part", pose_json(location.mcs_from_part)},
                     {"pivot_mcs_mm", vector_json(location.pivot_mcs_mm)},
                     {"covariance", covariance_json(location.covariance)},
                     {"rms_mm", location.rms_mm}};
    for (std::size_t i = 0; i < points.size(); ++i)
      document["points"].push_back(
          {{"name", points[i].name}, {"residual_mcs_mm", vector_json(location.residual_mcs_mm[i])}});
    fmt::print("{}\n", document.dump(2));
    return ExitCode::done;
  }
  fmt::print("{:<16} {:>10}\n", "point", "off by mm");
  for (std::size_t i = 0; i < points.size(); ++i)
    fmt::print("{:<16} {:>10.4f}\n", points[i].name, location.residual_mcs_mm[i].norm());
  fmt::print("\n{}", location_text(location, points.size()));
  return ExitCode::done;
}

}  // namespace

void add_calibration_commands(CLI::App& machine, CommandLine& line) {
  auto sphere = std::make_shared<CalibrateOptions>();
  CLI::App* calibrate_command =
      machine.add_subcommand("calibrate",
                             "Rotary axis and beam direction from scans of a reference sphere at several "
                             "rotary angles, on the scenario's "
                             "backend or from stored scans");
  calibrate_command->add_option("scenario", sphere->scenario, "Scenario file (YAML) whose part is the sphere")
      ->required()
      ->type_name("FILE");
  calibrate_command
      ->add_option("--scans", sphere->scans,
                   "Scans of the sphere by `trueblade scan`, in any number of files, instead of measuring")
      ->type_name("FILE");
  calibrate_command->add_option("--out", sphere->out, "Machine file (YAML) to write: the geometry found")
      ->required()
      ->type_name("FILE");
  calibrate_command->add_flag("--resume", sphere->resume,
                              "Go on with the scan in the journal beside the file to write");
  calibrate_command->add_flag("--json", line.json, "As JSON on standard output, with the covariance");
  calibrate_command->footer(R"(
Example:
  trueblade machine calibrate scenarios/calibration_sphere.yaml --out geometry.yaml)");
  calibrate_command->callback(
      [sphere, &line] { line.chosen = [sphere, &line] { return calibrate(*sphere, line.json); }; });

  auto options = std::make_shared<TouchOptions>();
  CLI::App* touch_command = machine.add_subcommand(
      "touch", "Read the probe where it stands as a named point of the part. Nothing moves");
  CLI::App* locate_command = machine.add_subcommand(
      "locate", "Where the part stands (mcs_from_part), from three or more touched points");
  for (CLI::App* command : {touch_command, locate_command}) {
    command->add_option("--machine", options->machine, "Machine file (YAML)")->required()->type_name("FILE");
    command->add_option("--points", options->points, "File of touched points (YAML); touch adds to it")
        ->required()
        ->type_name("FILE");
  }
  touch_command->add_option("--name", options->name, "Name of the point; touched again, it is replaced")
      ->required();
  touch_command->add_option("--part-mm", options->part_mm, "Its coordinates in the part's frame")
      ->required()
      ->expected(3)
      ->type_name("X Y Z");
  touch_command->callback([options, &line] { line.chosen = [options] { return touch(*options); }; });
  locate_command->add_option("--out", options->out, "Machine file (YAML) to write: the transformation found")
      ->type_name("FILE");
  locate_command->add_flag("--json", line.json, "As JSON on standard output, with the covariance");
  locate_command->callback(
      [options, &line] { line.chosen = [options, &line] { return locate(*options, line.json); }; });
}

}  // namespace trueblade
