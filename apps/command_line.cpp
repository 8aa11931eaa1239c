#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "apps/command.h"
#include "apps/command_machine.h"
#include "apps/console.h"
#include "apps/interrupt.h"
#include "apps/nearest_word.h"
#include "apps/version.h"
#include "geometry/error.h"
#include "hardware/machine_driver.h"

namespace trueblade {
namespace {

constexpr const char* kExamples = R"(
Examples:
  trueblade inspect scenarios/turbine_blade_front.yaml
      scans the demonstration blade on the simulated machine, registers the scan to the CAD model, prints
      the table and writes the report to results/runs/turbine_blade_front
  trueblade plan scenarios/turbine_blade_front.yaml
      which surfaces the views see, how much of each, where not and why; points and time of each view
  trueblade part info blade.step
      what is in a CAD or mesh file: surfaces, facets, size, defects
  trueblade register --part blade.step --scan points.xyz --scan-unit mm --out report
      aligns measured points from any machine to a part and reports the deviations
  trueblade study scenarios/studies/paper_case.yaml
      repeats a virtual inspection with its errors drawn anew: how accurate is this set-up?
  trueblade regress scenarios/paper/*.yaml
      holds scenarios to their own `expect:` blocks

Exit codes: 0 done; 1 ran, but an expectation, a tolerance or the convergence failed; 2 bad input or usage;
3 machine fault; 130 interrupted by Ctrl-C (what was finished is kept).
`trueblade COMMAND --help` explains a command.)";

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : commands_of(app))
    if (command->get_name() == name) return command;
  return nullptr;
}

// CLI11 only says that a command is required; a newcomer wants to know which one was meant.
std::optional<std::string> unknown_command(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::App* command = &app;
  for (const std::string& word : arguments) {
    const std::vector<std::string> known = names_of(commands_of(*command));
    if (command->get_require_subcommand_min() == 0 || known.empty() || word.starts_with("-"))
      return std::nullopt;
    const CLI::App* next = find_command(*command, word);
    if (!next) {
      const auto nearest = nearest_word(word, known);
      return fmt::format("there is no command \"{} {}\"{}; the commands are {}", command->get_name(), word,
                         nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "",
                         fmt::join(known, ", "));
    }
    command = next;
  }
  return std::nullopt;
}

// What the command line meant to call, and its name with those before it: "trueblade study show".
std::pair<const CLI::App*, std::string> called_command(const CLI::App& app,
                                                       const std::vector<std::string>& arguments) {
  std::pair<const CLI::App*, std::string> called{&app, app.get_name()};
  for (const std::string& word : arguments)
    if (const CLI::App* next = find_command(*called.first, word))
      called = {next, called.second + " " + next->get_name()};
  return called;
}

// CLI11's own words, the options that are nearest to unknown ones, and where to read more.
std::string usage_error(const CLI::App& app, const std::vector<std::string>& arguments,
                        const CLI::ParseError& stop) {
  const auto [command, name] = called_command(app, arguments);
  std::vector<std::string> known;
  for (const CLI::Option* option : command->get_options()) known.push_back(option->get_name());
  std::string text = stop.what();
  for (const std::string& word : arguments) {
    const bool is_known = std::find(known.begin(), known.end(), word) != known.end();
    if (is_known || !word.starts_with("--")) continue;
    if (const auto nearest = nearest_word(word, known))
      text += fmt::format("; \"{}\": did you mean \"{}\"?", word, *nearest);
  }
  return fmt::format("{} (`{} --help` explains)", text, name);
}

int parse_and_run(const std::vector<std::string>& arguments) {
  CLI::App app(
      "Inspects free-form parts: scans them on a simulated or real machine, registers the scan to the\n"
      "CAD model and reports the deviations.",
      "trueblade");
  app.footer(kExamples);
  app.require_subcommand(1);
  app.set_version_flag("--version",
                       fmt::format("trueblade {} (commit {})", program_version(), program_commit()),
                       "Print the version and the commit");

  CommandLine line;
  add_inspect_command(app, line);
  add_plan_command(app, line);
  add_scan_command(app, line);
  add_register_command(app, line);
  add_part_command(app, line);
  add_regress_command(app, line);
  add_image_command(app, line);
  add_study_command(app, line);
  add_report_command(app, line);
  add_compare_command(app, line);
  add_machine_command(app, line);

  if (const auto unknown = unknown_command(app, arguments)) throw InputError(*unknown);
  try {
    // CLI11 takes the words from the back.
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& stop) {
    const bool asked_for_help = stop.get_exit_code() == 0;
    if (!asked_for_help) throw InputError(usage_error(app, arguments, stop));
    app.exit(stop);
    return ExitCode::done;
  }
  const int code = line.chosen();
  if (!interrupted()) return code;
  spdlog::warn("interrupted; what was finished is kept");
  return ExitCode::interrupted_by_user;
}

}  // namespace

CLI::Validator whole_number() {
  return CLI::Validator(
      [](std::string& text) {
        const bool counts = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char letter) {
          return letter >= '0' && letter <= '9';
        });
        return counts ? std::string() : text + " is no whole number from 0";
      },
      "");
}

int run_command_line(std::vector<std::string> arguments) {
  start_log();
  catch_interrupts();
  try {
    return parse_and_run(arguments);
  } catch (const InputError& failure) {
    spdlog::error("error: {}", failure.what());
    return ExitCode::bad_input;
  } catch (const MachineFault& failure) {
    spdlog::error("{}: {}", interrupted() ? "interrupted" : "machine fault", failure.what());
    return interrupted() ? ExitCode::interrupted_by_user : ExitCode::machine_fault;
  } catch (const std::bad_alloc&) {
    spdlog::error("error: the input needs more memory than there is");
    return ExitCode::bad_input;
  } catch (const std::filesystem::filesystem_error& failure) {
    spdlog::error("error: {}", failure.what());
    return ExitCode::bad_input;
  }
}

}  // namespace trueblade
