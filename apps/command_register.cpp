#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/cautions.h"
#include "apps/command.h"
#include "apps/evaluate_view.h"
#include "apps/pose_file.h"
#include "apps/registration_fields.h"
#include "apps/run_folder.h"
#include "apps/run_report.h"
#include "apps/version.h"
#include "geometry/atomic_file.h"
#include "inspection/deviation_ply.h"
#include "inspection/result_json.h"
#include "inspection/table.h"
#include "part/read_points.h"
#include "registration/compare_variants.h"
#include "registration/rejection.h"

namespace trueblade {
namespace {

struct RegisterOptions {
  std::string part_file, unit;
  std::string scan_file, scan_unit;
  std::string initial_file;
  std::string preset = "default";
  std::string options_file;
  std::filesystem::path out;
  bool cross_check = false;
  bool compare = false;
};

std::optional<LengthUnit> unit_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return parse_length_unit(text);
}

RegistrationSpec registration_of(const RegisterOptions& options) {
  RegistrationSpec spec;
  if (options.options_file.empty()) {
    spec.preset = options.preset;
    spec.options = preset(options.preset);
  } else {
    spec = read_registration_options(options.options_file);
  }
  spec.options.cross_check |= options.cross_check;
  return spec;
}

void write_report(const std::filesystem::path& folder, const InspectionResult& result,
                  const EvaluatedView& view, const Part& part) {
  write_deviation_ply(folder / fmt::format("deviations_{}.ply", view.result.view), view.deviations,
                      view.result.view, result.run);
  write_result_json(folder / "result.json", result);
  write_run_report(folder, &part);
  spdlog::info("report: {}", folder.string());
}

// What the command reads.
struct Input {
  Part part;
  ScanPoints scan;
  ScanPose pose;
};

// Which units are confused when the scan is `ratio` times as large as the part, or as small.
std::string confused_units(double ratio) {
  constexpr std::pair<double, const char*> kFactors[] = {{10.0, "centimetres and millimetres"},
                                                         {25.4, "inches and millimetres"},
                                                         {1000.0, "metres and millimetres"}};
  for (const auto& [factor, units] : kFactors)
    // A scan of one side is a little smaller than the part; half the way from 10 to 25.4 is 1.59.
    if (std::abs(std::log(std::max(ratio, 1.0 / ratio) / factor)) < std::log(1.5))
      return fmt::format(" The factor is about {}: {} confused?", factor, units);
  return "";
}

// A scan may be of a small place, but hardly larger than the part, unless the unit is wrong.
void check_size(const Input& input, const RegisterOptions& options) {
  constexpr double kLargest = 3.0;     // with a part of the fixture in it
  constexpr double kSmall = 0.05;      // an inch taken for a millimetre, or a scan of one small place
  constexpr double kSmallest = 0.005;  // a metre taken for a millimetre: finds a place anywhere
  Eigen::AlignedBox3d scan;
  for (const Vec3& point : input.scan.position_mcs_mm) scan.extend(point);
  const double scan_mm = scan.sizes().norm();
  const double part_mm = (input.part.model.upper_corner_mm() - input.part.model.lower_corner_mm()).norm();
  const std::string sizes = fmt::format(
      "{}: the scan's box is {:.3g} mm across, the part's {:.3g} mm: are --scan-unit and --unit right?{}",
      options.scan_file, scan_mm, part_mm, confused_units(scan_mm / part_mm));
  if (!(scan_mm > 0.0)) return;  // no unit makes a box of points in one place; the registration refuses them
  if (scan_mm > kLargest * part_mm || scan_mm < kSmallest * part_mm) throw InputError(sizes);
  if (scan_mm < kSmall * part_mm) spdlog::warn("{}", sizes);
}

Input read_input(const RegisterOptions& options) {
  Input input;
  if (!options.initial_file.empty()) input.pose = read_scan_pose(options.initial_file);
  PartOptions part_options;
  part_options.unit = unit_of(options.unit);
  input.part = read_part(options.part_file, part_options);
  input.scan = read_points(options.scan_file, unit_of(options.scan_unit));
  spdlog::info("part {}: {} facets; scan {}: {} points", options.part_file, input.part.model.facet_count(),
               options.scan_file, input.scan.size());
  check_size(input, options);
  return input;
}

int run_registration(const RegisterOptions& options, bool json) {
  const RegistrationSpec registration = registration_of(options);
  const Input input = read_input(options);
  if (!options.out.empty()) create_output_folder(options.out);
  const RegistrationTarget target(input.part);
  ViewEvaluationOptions evaluation;
  evaluation.registration = registration.options;
  const EvaluatedView view = evaluate_view(target, "scan", input.scan, input.pose.part_from_mcs, evaluation,
                                           input.pose.true_part_from_mcs);
  InspectionResult result;
  result.run.program_version = fmt::format("{} ({})", program_version(), program_commit());
  result.run.date = date_now();
  result.run.machine = "points of " + options.scan_file;
  result.run.part = options.part_file;
  result.run.surfaces = input.part.surfaces.size();
  result.run.facets = input.part.model.facet_count();
  result.run.registration_preset = registration.preset;
  result.run.rejection_rule = in_words(registration.options.rejection);
  result.run.deviations_from = to_string(DeviationSurface::exact);
  result.run.colour_limit_mm = rounded_colour_limit_mm(view.result.statistics.rms_mm);
  result.views.push_back(view.result);
  if (!options.out.empty()) write_report(options.out, result, view, input.part);

  if (json)
    fmt::print("{}\n", result_json(result).dump(2));
  else
    fmt::print("{}", inspection_table(result));
  const auto& cross_check = view.result.registration.cross_check;
  if (!json && cross_check && cross_check->agrees) fmt::print("The cross-check {}\n", cross_check->summary);
  for (const std::string& caution : cautions(view.result)) spdlog::warn("{}", caution);
  return is_sound(view.result.registration) ? ExitCode::done : ExitCode::expectation_failed;
}

nlohmann::ordered_json variant_json(const VariantResult& row) {
  const RegistrationResult& r = row.result;
  nlohmann::ordered_json json{{"variant", row.name},
                              {"termination", to_string(r.termination)},
                              {"iterations", r.iterations},
                              {"closest_points", r.work.queries},
                              {"facets_tested", r.work.facets_tested},
                              {"cache_hits", r.work.cache_hits},
                              {"time_s", row.time_s},
                              {"inliers", r.inliers},
                              {"rms_mm", r.rms_mm}};
  if (row.centroid_error_mm) json["translation_error_mm"] = *row.centroid_error_mm;
  if (row.rotation_error_rad) json["rotation_error_rad"] = *row.rotation_error_rad;
  return json;
}

constexpr const char* kComparisonNotes = R"(
variant          zhu2007: as published; with one part exchanged where it says so; default: what `register` does
stopped by       converged ...: by its rule (statistically: the step is small against the pose's own uncertainty);
                 no_descent: no step lowers the distances further; all else is no result
closest points   searched for, over all iterations
facets per query facets measured for one of them
from cache       share of them that the facet of an earlier iteration answered
time ms          of the registration, without building the search structures
inliers          points that the last rejection kept
RMS um           of the inliers' distances from the part
centroid error   of the scan's centroid, and rotation error: against the true pose, where --initial states it
)";

int run_comparison(const RegisterOptions& options, bool json) {
  const Input input = read_input(options);
  const RegistrationTarget target(input.part);
  const auto results =
      compare_variants(target, input.scan, input.pose.part_from_mcs, input.pose.true_part_from_mcs);
  if (json) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const VariantResult& row : results) rows.push_back(variant_json(row));
    fmt::print("{}\n", rows.dump(2));
  } else {
    fmt::print("{}{}", variants_table(results), kComparisonNotes);
  }
  return ExitCode::done;
}

}  // namespace

void add_register_command(CLI::App& app, CommandLine& line) {
  auto options = std::make_shared<RegisterOptions>();
  CLI::App* command =
      app.add_subcommand("register", "Align measured points from a file to a part and report the deviations");
  command->add_option("--part", options->part_file, "STEP, IGES, STL, PLY or OBJ file")
      ->required()
      ->type_name("FILE");
  command->add_option("--unit", options->unit, "Unit of an STL, PLY or OBJ part: mm, cm, m, in or um")
      ->type_name("UNIT");
  command->add_option("--scan", options->scan_file, "Points: PLY, XYZ, ASC, TXT, CSV or PCD file")
      ->required()
      ->type_name("FILE");
  command->add_option("--scan-unit", options->scan_unit, "Unit of the points, unless the file states it")
      ->type_name("UNIT");
  command
      ->add_option(
          "--initial", options->initial_file,
          "Where the scan lies to begin with: YAML or JSON with part_from_mcs: {rotation_wxyz: [w, x, y, z], "
          "translation_mm: [x, y, z]}, and true_part_from_mcs where it is known, as `trueblade scan` writes "
          "(default: as the coordinates are)")
      ->type_name("FILE");
  CLI::Option* preset_option =
      command->add_option("--preset", options->preset, "default, or zhu2007: as published")
          ->type_name("NAME");
  CLI::Option* options_option =
      command->add_option("--options", options->options_file, "Registration options (YAML), as in a scenario")
          ->type_name("FILE")
          ->excludes(preset_option);
  CLI::Option* out_option =
      command
          ->add_option("--out", options->out,
                       "Folder for result.json, deviations_scan.ply, report.html and the CSV tables")
          ->type_name("DIR");
  CLI::Option* cross_check_flag = command->add_flag("--cross-check", options->cross_check,
                                                    "Compare the result with independent answers by Ceres");
  command
      ->add_flag("--compare", options->compare,
                 "Register by every published variant instead, and print them side by side")
      ->excludes(preset_option)
      ->excludes(options_option)
      ->excludes(out_option)
      ->excludes(cross_check_flag);
  command->add_flag("--json", line.json, "Print result.json on standard output instead of the table");
  command->footer(R"(
Example:
  trueblade register --part blade.step --scan points.xyz --scan-unit mm --out report
  trueblade register --part blade.step --scan scan.ply --initial scan.pose.yaml --compare)");
  command->callback([options, &line] {
    line.chosen = [options, &line] {
      return options->compare ? run_comparison(*options, line.json) : run_registration(*options, line.json);
    };
  });
}

}  // namespace trueblade
