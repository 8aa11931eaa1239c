#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "apps/command.h"
#include "apps/plan_scan.h"
#include "geometry/atomic_file.h"
#include "hardware/coverage_report.h"
#include "inspection/coverage_png.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct PlanCommandOptions {
  std::string scenario;
  std::filesystem::path out;
  bool automatic = false;
  std::vector<double> theta_deg;
};

struct Planned {
  ViewsWithCoverage chosen;
  std::vector<ScanPlan> plans;
  std::vector<double> time_s;
};

// The command line overrides what the scenario says about views.
void apply(const PlanCommandOptions& options, Scenario& scenario) {
  if (options.automatic && !scenario.scan.automatic_views) scenario.scan.automatic_views.emplace();
  if (options.theta_deg.empty()) return;
  scenario.scan.automatic_views.reset();
  scenario.scan.views.clear();
  for (const double theta_deg : options.theta_deg)
    scenario.scan.views.push_back({fmt::format("theta_{:g}", theta_deg), theta_deg * kDegree});
}

std::string views_table(const Planned& planned) {
  std::string text = fmt::format("\n{:<14} {:>9} {:>8} {:>7} {:>9} {:>8}\n", "view", "theta deg", "points",
                                 "lines", "grid", "time s");
  std::size_t points = 0;
  for (std::size_t v = 0; v < planned.plans.size(); ++v) {
    const ScanPlan& plan = planned.plans[v];
    text += fmt::format("{:<14} {:>9.1f} {:>8} {:>7} {:>9} {:>8.0f}\n", plan.view, plan.theta_rad / kDegree,
                        plan.point_count(), plan.lines.size(), fmt::format("{}x{}", plan.columns, plan.rows),
                        planned.time_s[v]);
    points += plan.point_count();
  }
  return text + fmt::format("{} points in {:.0f} s, from home to the end of the last retreat\n", points,
                            std::accumulate(planned.time_s.begin(), planned.time_s.end(), 0.0));
}

// A dozen names at most; --json names them all by their planned points.
void tell_surfaces_between_points(const std::vector<std::uint32_t>& surfaces, const Part& part,
                                  double spacing_mm) {
  if (surfaces.empty()) return;
  constexpr std::size_t kMostNames = 12;
  std::string names;
  for (std::size_t k = 0; k < std::min(kMostNames, surfaces.size()); ++k)
    names += fmt::format("{}{} ({})", k == 0 ? "" : ", ", surfaces[k], part.surfaces[surfaces[k]].name);
  if (surfaces.size() > kMostNames) names += ", ...";
  spdlog::warn("spacing_mm is {}: too coarse for {} surfaces that can be seen, but have no planned point: {}",
               spacing_mm, surfaces.size(), names);
}

// To be pasted into the scenario, and changed there.
std::string views_yaml(const std::vector<ViewSpec>& views) {
  std::string text =
      "\nChosen automatically; to keep or to change them, state in the scenario:\n  scan:\n    views:\n";
  for (const ViewSpec& view : views)
    text += fmt::format("      - {{name: {}, theta_deg: {:g}}}\n", view.name, view.theta_rad / kDegree);
  return text;
}

nlohmann::ordered_json plan_json(const Scenario& scenario, const Planned& planned, const Part& part) {
  const Coverage& coverage = planned.chosen.coverage;
  nlohmann::ordered_json views = nlohmann::ordered_json::array(), surfaces = nlohmann::ordered_json::array();
  std::vector<std::size_t> points_on(part.surfaces.size(), 0);
  for (std::size_t v = 0; v < planned.plans.size(); ++v) {
    const ScanPlan& plan = planned.plans[v];
    for (const PlannedPoint& point : plan.points) ++points_on[point.surface];
    views.push_back({{"view", plan.view},
                     {"theta_deg", plan.theta_rad / kDegree},
                     {"points", plan.point_count()},
                     {"without_return", missing_returns(scenario.machine, plan)},
                     {"lines", plan.lines.size()},
                     {"columns", plan.columns},
                     {"rows", plan.rows},
                     {"time_s", planned.time_s[v]}});
  }
  for (const SurfaceCoverage& surface : coverage.surfaces) {
    nlohmann::ordered_json share;
    for (std::size_t k = 0; k < kPointAccessCount; ++k)
      share[to_string(static_cast<PointAccess>(k))] = surface.by_access[k];
    surfaces.push_back({{"surface", surface.surface},
                        {"name", part.surfaces[surface.surface].name},
                        {"area_mm2", surface.area_mm2},
                        {"planned_points", points_on[surface.surface]},
                        {"seen", surface.seen},
                        {"seen_from_view", surface.seen_from_view},
                        {"share", share}});
  }
  const auto& coverable = planned.chosen.coverable;
  return {{"seen", coverage.seen},
          {"coverable", coverable ? nlohmann::ordered_json(*coverable) : nlohmann::ordered_json(nullptr)},
          {"views", views},
          {"surfaces", surfaces}};
}

std::vector<Viewpoint> viewpoints(const Scenario& scenario, const std::vector<ViewSpec>& views) {
  std::vector<Viewpoint> result;
  for (const ViewSpec& view : views)
    result.push_back(viewpoint_of_view(view.name, scenario.machine.geometry, view.theta_rad,
                                       scenario.machine.mcs_from_part.inverse()));
  return result;
}

int plan(const PlanCommandOptions& options, bool json) {
  Scenario scenario = read_scenario(options.scenario);
  apply(options, scenario);
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("results/runs") / scenario.name : options.out;
  const PartOnMachine nominal = put_on_machine(make_part(scenario.part));
  const Part& part = *nominal.part;
  create_output_folder(folder);

  Planned planned;
  planned.chosen = choose_and_cover(scenario, nominal);
  const Coverage& coverage = planned.chosen.coverage;
  // The pictures come before the plan is tried: they explain a plan that fails.
  write_file_atomically(folder / "coverage.svg",
                        [&](std::ostream& out) { out << coverage_svg(coverage, part); });
  render_coverage_png(folder / "coverage.png", part, *nominal.caster, coverage,
                      viewpoints(scenario, planned.chosen.views));

  UnseenViews unseen;
  planned.plans = plan_views(scenario, nominal, planned.chosen.views, &unseen);
  for (const auto& [view, reason] : unseen) spdlog::warn("{}", reason);
  for (const ScanPlan& plan : planned.plans) {
    const std::string missing = missing_returns(scenario.machine, plan);
    if (!missing.empty()) spdlog::warn("view {}: {}", plan.view, missing);
  }
  tell_surfaces_between_points(surfaces_between_points(coverage, planned.plans), part,
                               scenario.scan.spacing_mm);
  planned.time_s = estimated_times_s(scenario.machine, planned.plans);
  if (json) {
    fmt::print("{}\n", plan_json(scenario, planned, part).dump(2));
    return ExitCode::done;
  }
  fmt::print("{}", coverage_table(coverage, part));
  if (planned.chosen.coverable)
    fmt::print("all candidate angles together could see {:.1f} %\n", 100.0 * *planned.chosen.coverable);
  fmt::print("{}", views_table(planned));
  if (scenario.scan.automatic_views) fmt::print("{}", views_yaml(planned.chosen.views));
  fmt::print(
      "\nPictures: {0}/coverage.svg (surfaces by views), {0}/coverage.png (the part as each view sees it)\n",
      folder.string());
  return ExitCode::done;
}

}  // namespace

void add_plan_command(CLI::App& app, CommandLine& line) {
  auto options = std::make_shared<PlanCommandOptions>();
  CLI::App* command = app.add_subcommand(
      "plan", "Plan the scan without moving: coverage of every surface by every view, points and time");
  command->add_option("scenario", options->scenario, "Scenario file (YAML)")->required()->type_name("FILE");
  command->add_option("--out", options->out, "Folder of the pictures (default: results/runs/<scenario name>)")
      ->type_name("DIR");
  CLI::Option* automatic = command->add_flag("--automatic", options->automatic,
                                             "Choose the views for coverage, whatever the scenario states");
  command
      ->add_option("--theta-deg", options->theta_deg, "Rotary angles of the views, instead of the scenario's")
      ->check(CLI::Range(-360.0, 360.0))
      ->excludes(automatic)
      ->type_name("DEG");
  command->add_flag("--json", line.json, "Print coverage and plan as JSON on standard output");
  command->footer(R"(
The plan is checked as `scan` and `inspect` check theirs before anything moves: travel of the axes, and the way of
the probe past the part, light that comes back (of a simulated sensor, by its mean signal).

Examples:
  trueblade plan scenarios/turbine_blade_front.yaml
  trueblade plan scenarios/turbine_blade_front.yaml --automatic
  trueblade plan scenarios/turbine_blade_front.yaml --theta-deg 0 120 240)");
  command->callback(
      [options, &line] { line.chosen = [options, &line] { return plan(*options, line.json); }; });
}

}  // namespace trueblade
