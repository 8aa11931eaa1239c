#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "apps/cautions.h"
#include "apps/command.h"
#include "apps/inspect_scenario.h"
#include "inspection/result_json.h"
#include "inspection/table.h"

namespace trueblade {
namespace {

struct InspectOptions {
  std::string scenario;
  std::filesystem::path out;
  std::optional<std::uint64_t> seed;
  bool resume = false;
};

// Outliers may be errors of the measurement or of the part: where they lie outside, the tolerance is not kept
// before someone has looked.
bool keeps_tolerance(const ViewResult& view, const std::pair<double, double>& tolerance_mm) {
  const ToleranceCounts& counts = *view.tolerance;
  if (counts.over + counts.under > 0)
    spdlog::warn("view {}: deviations from {:.4f} to {:.4f} mm leave the tolerance of {} to {} mm", view.view,
                 view.statistics.min_mm, view.statistics.max_mm, tolerance_mm.first, tolerance_mm.second);
  else if (counts.outliers_outside > 0)
    spdlog::warn("view {}: cannot tell: {} outliers lie outside the tolerance of {} to {} mm", view.view,
                 counts.outliers_outside, tolerance_mm.first, tolerance_mm.second);
  return counts.over + counts.under + counts.outliers_outside == 0;
}

// Tells what the numbers alone do not, and returns whether everything is as it should be.
bool tell_verdict(const Scenario& scenario, const ViewResult& view) {
  for (const std::string& caution : cautions(view)) spdlog::warn("{}", caution);
  if (!view.failure.empty()) return false;
  const auto& tolerance = scenario.inspection.tolerance_mm;
  const bool tolerance_kept = !tolerance || keeps_tolerance(view, *tolerance);
  const auto& cross_check = view.registration.cross_check;
  if (cross_check && cross_check->agrees)
    spdlog::info("view {}: the cross-check {}", view.view, cross_check->summary);
  return tolerance_kept && is_sound(view.registration);
}

bool tell_decisions(const EvaluationResult& evaluation) {
  bool all_conform = true;
  for (const ProfileResult& profile : evaluation.profiles) {
    if (profile.conformity == Conformity::conforming) continue;
    all_conform = false;
    spdlog::warn("profile {}: {}: {}", profile.callout.name, to_string(profile.conformity), profile.reason);
  }
  for (const std::string& missing : evaluation.missing_features) spdlog::warn("{}", missing);
  return all_conform;
}

// Ctrl-C, or a view that failed, leaves only some of the files of a run: those that are there are named.
void print_files(const InspectionResult& result, const std::filesystem::path& folder) {
  const auto tell = [&](const std::string& file, const std::string& what) {
    if (std::filesystem::exists(folder / file)) fmt::print("  {}  {}\n", file, what);
  };
  fmt::print("\nReport: {}\n", folder.string());
  for (const ViewResult& view : result.views) {
    tell(view.view + ".png", "the part with the points coloured by deviation");
    tell(fmt::format("deviations_{}.ply", view.view), "the same for CloudCompare or MeshLab");
    tell(fmt::format("scan_{}.ply", view.view), "the points as measured");
    tell(view.view + ".exr", "the range image");
  }
  tell("pictures/oblique.png", "the part with the points of all views, and beside it along every axis");
  tell("report.html", "all of it to look at, in any browser, without a network");
  tell("statistics.csv", "of each view and surface, for a spreadsheet");
  tell("features.csv", "profiles, sections and offsets, for a spreadsheet");
  tell("result.json", "all numbers");
  tell("resolved.yaml", "the scenario with all defaults, which runs again");
}

void print_run(const InspectionRun& run, const std::filesystem::path& folder) {
  if (run.result.views.empty()) {
    fmt::print("No view was finished: there is no report. {} holds what was measured; --resume goes on.\n",
               folder.string());
    return;
  }
  fmt::print("{}", inspection_table(run.result));
  fmt::print(R"(
RMS, min and max are signed distances of the measured points from the nominal surface after registration, positive
outside the material; points beyond 3 standard deviations (black in the picture) are left out. The initial RMS is
that of the machine set-up alone. The pose error, at the scan's centroid, compares with the true pose, which only a
simulation knows. Time is that of the registration.
)");
  print_files(run.result, folder);
}

int inspect(const InspectOptions& options, bool json) {
  Scenario scenario = read_scenario(options.scenario);
  if (options.seed) scenario.seed = *options.seed;
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("results/runs") / scenario.name : options.out;
  const InspectionRun run = inspect_scenario(scenario, folder, options.resume);

  if (json) {
    fmt::print("{}\n", result_json(run.result).dump(2));
  } else {
    print_run(run, folder);
  }
  bool all_well = true, all_made = run.result.evaluation.missing.empty();
  for (const ViewResult& view : run.result.views) {
    all_well &= tell_verdict(scenario, view);
    all_made &= view.failure.empty();
  }
  for (const std::string& missing : run.result.evaluation.missing) spdlog::error("missing: {}", missing);
  all_well &= tell_decisions(run.result.evaluation);
  if (!all_made) return ExitCode::bad_input;
  return all_well ? ExitCode::done : ExitCode::expectation_failed;
}

}  // namespace

void add_inspect_command(CLI::App& app, CommandLine& line) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand(
      "inspect", "Scan on the scenario's machine, register every view to the part, evaluate, report");
  command->add_option("scenario", options->scenario, "Scenario file (YAML)")->required()->type_name("FILE");
  command->add_option("--out", options->out, "Folder of the report (default: results/runs/<scenario name>)")
      ->type_name("DIR");
  command->add_option("--seed", options->seed, "Seed of the simulated errors, instead of the scenario's")
      ->check(whole_number())
      ->type_name("N");
  command->add_flag("--resume", options->resume,
                    "Go on with the scan in the folder's journal: what it holds is not measured again");
  command->add_flag("--json", line.json, "Print result.json on standard output instead of the table");
  command->footer(R"(
Example:
  trueblade inspect scenarios/turbine_blade_front.yaml --out /tmp/report --seed 7)");
  command->callback(
      [options, &line] { line.chosen = [options, &line] { return inspect(*options, line.json); }; });
}

}  // namespace trueblade
