#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/interrupt.h"
#include "apps/measure.h"
#include "apps/pose_file.h"
#include "geometry/atomic_file.h"
#include "hardware/scan_file.h"

namespace trueblade {
namespace {

struct ScanOptions {
  std::string scenario;
  std::filesystem::path out;
  std::optional<std::uint64_t> seed;
  bool resume = false;
};

// One view: the file as named. Several: scan.ply becomes scan_front.ply, scan_back.ply ...
std::filesystem::path file_of_view(const ScanOptions& options, std::size_t views, const std::string& view) {
  if (views == 1) return options.out;
  const std::string name =
      fmt::format("{}_{}{}", options.out.stem().string(), view, options.out.extension().string());
  return options.out.parent_path() / name;
}

int scan(const ScanOptions& options, bool json) {
  if (options.out.extension() != ".ply")
    throw InputError(
        fmt::format("--out is {}, must end in .ply: that is what is written", options.out.string()));
  Scenario scenario = read_scenario(options.scenario);
  if (options.seed) scenario.seed = *options.seed;
  const PartOnMachine nominal = put_on_machine(make_part(scenario.part));
  Measurement measurement(scenario, nominal);
  create_output_folder(std::filesystem::absolute(options.out).parent_path());
  measurement.keep_journal(std::filesystem::path(options.out).replace_extension("journal"), options.resume);

  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const ScanPlan& plan : measurement.plans()) {
    const MeasuredView measured = measurement.measure(plan);
    const std::filesystem::path file = file_of_view(options, measurement.plans().size(), plan.view);
    write_scan(file, measured.scan);
    const std::filesystem::path pose_file = std::filesystem::path(file).replace_extension(".pose.yaml");
    ScanPose pose{scenario.machine.mcs_from_part.inverse(), std::nullopt};
    if (measured.truth) pose.true_part_from_mcs = measured.truth->part_from_mcs;
    write_scan_pose(pose_file, pose);
    files.push_back({{"view", plan.view},
                     {"file", file.string()},
                     {"pose_file", pose_file.string()},
                     {"planned", measured.planned},
                     {"samples", measured.scan.samples.size()},
                     {"points", measured.scan.points.size()},
                     {"complete", measured.scan.complete}});
    if (!json)
      fmt::print("{}: {} points of {} planned -> {}\n", plan.view, measured.scan.points.size(),
                 measured.planned, file.string());
    if (interrupted()) break;
  }
  if (json) fmt::print("{}\n", files.dump(2));
  return ExitCode::done;
}

}  // namespace

void add_scan_command(CLI::App& app, CommandLine& line) {
  auto options = std::make_shared<ScanOptions>();
  CLI::App* command =
      app.add_subcommand("scan",
                         "Only measure: write the points of every view as PLY, and beside them "
                         "(.pose.yaml) where they lie by the set-up, for register --initial");
  command->add_option("scenario", options->scenario, "Scenario file (YAML)")->required()->type_name("FILE");
  command->add_option("--out", options->out, "Scan file (.ply); several views add _<view> to its name")
      ->required()
      ->type_name("FILE");
  command->add_option("--seed", options->seed, "Seed of the simulated errors, instead of the scenario's")
      ->check(whole_number())
      ->type_name("N");
  command->add_flag(
      "--resume", options->resume,
      "Go on with the scan in the journal beside the scan file: what it holds is not measured again");
  command->add_flag("--json", line.json, "Print the list of files as JSON on standard output");
  command->footer(R"(
Example:
  trueblade scan scenarios/turbine_blade_front.yaml --out blade.ply)");
  command->callback(
      [options, &line] { line.chosen = [options, &line] { return scan(*options, line.json); }; });
}

}  // namespace trueblade
