#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/command.h"
#include "apps/inspect_scenario.h"
#include "apps/interrupt.h"
#include "apps/junit.h"
#include "geometry/atomic_file.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

struct RegressOptions {
  std::vector<std::string> scenarios;
  std::string junit;
};

Verdict judge_refusal(const Scenario& scenario) {
  Verdict verdict;
  verdict.view = "scenario";
  verdict.quantity = "error";
  verdict.expected_text = scenario.expect_error;
  verdict.got_text = "was not refused";
  try {
    inspect_scenario(scenario, std::nullopt);
  } catch (const InputError& refusal) {
    verdict.got_text = refusal.what();
    verdict.holds = verdict.got_text.find(scenario.expect_error) != std::string::npos;
  }
  return verdict;
}

RegressionCase run_case(const std::string& file) {
  const auto start = std::chrono::steady_clock::now();
  RegressionCase regression;
  regression.scenario = std::filesystem::path(file).stem().string();
  try {
    const Scenario scenario = read_scenario(file);
    if (scenario.expect.empty() && scenario.expect_part.empty() && scenario.expect_error.empty())
      throw InputError(fmt::format("{}: has no expect block, so there is nothing to hold it to", file));
    if (!scenario.expect_error.empty()) {
      regression.verdicts = {judge_refusal(scenario)};
      return regression;
    }
    const InspectionRun run = inspect_scenario(scenario, std::nullopt);
    regression.verdicts = judge(scenario.expect, run.result.views);
    const std::vector<Verdict> of_part = judge_part(scenario.expect_part, run.result.evaluation);
    regression.verdicts.insert(regression.verdicts.end(), of_part.begin(), of_part.end());
  } catch (const InputError& failure) {
    regression.error = failure.what();
  } catch (const MachineFault& fault) {
    regression.error = fault.what();
  }
  regression.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return regression;
}

// All at once on as many threads as the machine has; each works on its own scenarios, and the loops inside a
// scenario share the threads of the library.
std::vector<RegressionCase> run_cases(const std::vector<std::string>& files) {
  std::vector<RegressionCase> cases(files.size());
  std::vector<char> ended(files.size(), 0);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < files.size() && !interrupted(); i = next++) {
      cases[i] = run_case(files[i]);
      ended[i] = !interrupted();
    }
  };
  std::vector<std::thread> workers;
  const std::size_t count = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, files.size());
  for (std::size_t w = 0; w < count; ++w) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  std::vector<RegressionCase> finished;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (ended[i]) finished.push_back(std::move(cases[i]));
  return finished;
}

void print_case(const RegressionCase& regression) {
  fmt::print("{}  {}  {:.1f} s\n", regression.passed() ? "pass" : "FAIL", regression.scenario,
             regression.time_s);
  if (!regression.error.empty()) fmt::print("      {}\n", regression.error);
  for (const Verdict& verdict : regression.verdicts)
    fmt::print("  {}  {:<12} {:<34} expected {:<26} got {}\n", verdict.holds ? "ok  " : "FAIL", verdict.view,
               verdict.quantity, expected_words(verdict), got_words(verdict));
}

Json case_json(const RegressionCase& regression) {
  Json verdicts = Json::array();
  for (const Verdict& verdict : regression.verdicts)
    verdicts.push_back(
        {{"view", verdict.view},
         {"quantity", verdict.quantity},
         {"expected",
          verdict.expected_text.empty() ? Json({verdict.low, verdict.high}) : Json(verdict.expected_text)},
         {"got", verdict.expected_text.empty() ? Json(verdict.got) : Json(verdict.got_text)},  // NaN: null
         {"holds", verdict.holds}});
  return {{"scenario", regression.scenario},
          {"passed", regression.passed()},
          {"error", regression.error.empty() ? Json(nullptr) : Json(regression.error)},
          {"time_s", regression.time_s},
          {"verdicts", verdicts}};
}

int regress(const RegressOptions& options, bool json) {
  // What runs side by side would speak at once; the table says what came of it.
  spdlog::set_level(spdlog::level::err);
  const std::vector<RegressionCase> cases = run_cases(options.scenarios);
  if (!json)
    for (const RegressionCase& one : cases) print_case(one);
  if (!options.junit.empty())
    write_file_atomically(options.junit, [&](std::ostream& out) { out << junit_xml(cases); });

  const auto failed = static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const RegressionCase& one) { return !one.passed(); }));
  if (json) {
    Json document = Json::array();
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
  trueblade regress scenarios/turbine_blade_front.yaml scenarios/paper/*.yaml --junit regress.xml)");
  command->callback(
      [options, &line] { line.chosen = [options, &line] { return regress(*options, line.json); }; });
}

}  // namespace trueblade
