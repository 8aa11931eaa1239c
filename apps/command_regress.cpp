#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/inspect_scenario.h"
#include "apps/interrupt.h"
#include "apps/junit.h"
#include "geometry/atomic_file.h"

namespace trueblade {
namespace {

struct RegressOptions {
  std::vector<std::string> scenarios;
  std::string junit;
};

RegressionCase run_case(const std::string& file) {
  const auto start = std::chrono::steady_clock::now();
  RegressionCase regression;
  regression.scenario = std::filesystem::path(file).stem().string();
  try {
    const Scenario scenario = read_scenario(file);
    if (scenario.expect.empty())
      throw InputError(fmt::format("{}: has no expect block, so there is nothing to hold it to", file));
    const InspectionRun run = inspect_scenario(scenario, std::nullopt);
    regression.verdicts = judge(scenario.expect, run.result.views);
  } catch (const InputError& failure) {
    regression.error = failure.what();
  }
  regression.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return regression;
}

void print_case(const RegressionCase& regression) {
  fmt::print("{}  {}  {:.1f} s\n", regression.passed() ? "pass" : "FAIL", regression.scenario,
             regression.time_s);
  if (!regression.error.empty()) fmt::print("      {}\n", regression.error);
  for (const Verdict& verdict : regression.verdicts)
    fmt::print("  {}  {:<12} {:<22} expected {:>9.5g} to {:>9.5g}   got {:>10.5g}\n",
               verdict.holds ? "ok  " : "FAIL", verdict.view, verdict.quantity, verdict.low, verdict.high,
               verdict.got);
}

nlohmann::ordered_json case_json(const RegressionCase& regression) {
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  for (const Verdict& verdict : regression.verdicts)
    verdicts.push_back({{"view", verdict.view},
                        {"quantity", verdict.quantity},
                        {"expected", {verdict.low, verdict.high}},
                        {"got", verdict.got},  // NaN is written as null
                        {"holds", verdict.holds}});
  return {{"scenario", regression.scenario},
          {"passed", regression.passed()},
          {"error", regression.error.empty() ? nlohmann::ordered_json(nullptr)
                                             : nlohmann::ordered_json(regression.error)},
          {"time_s", regression.time_s},
          {"verdicts", verdicts}};
}

int regress(const RegressOptions& options, bool json) {
  std::vector<RegressionCase> cases;
  for (const std::string& file : options.scenarios) {
    cases.push_back(run_case(file));
    if (interrupted()) {
      cases.pop_back();  // it did not run to its end
      break;
    }
    if (!json) print_case(cases.back());
  }
  if (!options.junit.empty())
    write_file_atomically(options.junit, [&](std::ostream& out) { out << junit_xml(cases); });

  const auto failed = static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const RegressionCase& one) { return !one.passed(); }));
  if (json) {
    nlohmann::ordered_json document = nlohmann::ordered_json::array();
    for (const RegressionCase& one : cases) document.push_back(case_json(one));
    fmt::print("{}\n", document.dump(2));
  } else {
    fmt::print("{} passed, {} failed\n", cases.size() - failed, failed);
  }
  return failed == 0 ? ExitCode::done : ExitCode::expectation_failed;
}

}  // namespace

void add_regress_command(CLI::App& app, CommandLine& line) {
  auto options = std::make_shared<RegressOptions>();
  CLI::App* command =
      app.add_subcommand("regress", "Run scenarios and hold them to their own `expect:` block");
  command->add_option("scenarios", options->scenarios, "Scenario files (YAML)")
      ->required()
      ->type_name("FILE");
  command->add_option("--junit", options->junit, "Write the verdicts as JUnit XML for a build server")
      ->type_name("FILE");
  command->add_flag("--json", line.json, "Print the verdicts as JSON on standard output");
  command->footer(R"(
Example:
  trueblade regress scenarios/*.yaml --junit regress.xml)");
  command->callback(
      [options, &line] { line.chosen = [options, &line] { return regress(*options, line.json); }; });
}

}  // namespace trueblade
