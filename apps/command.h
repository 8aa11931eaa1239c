// The commands of `trueblade`: each adds its options and help to the command line, and the work to be done
// when it is the one that was called.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace trueblade {

// Documented in `trueblade --help`.
enum ExitCode : int {
  done = 0,
  expectation_failed = 1,  // the command ran, but an expectation, a tolerance or the convergence failed
  bad_input = 2,           // or bad usage
  machine_fault = 3,
  interrupted_by_user = 130  // by Ctrl-C, as shells count it: 128 + SIGINT
};

struct CommandLine {
  bool json = false;            // the machine-readable result on standard output, instead of text
  std::function<int()> chosen;  // the command that was called; returns the exit code
};

void add_inspect_command(CLI::App& app, CommandLine& line);
void add_plan_command(CLI::App& app, CommandLine& line);
void add_scan_command(CLI::App& app, CommandLine& line);
void add_image_command(CLI::App& app, CommandLine& line);
void add_register_command(CLI::App& app, CommandLine& line);
void add_part_command(CLI::App& app, CommandLine& line);
void add_regress_command(CLI::App& app, CommandLine& line);
void add_study_command(CLI::App& app, CommandLine& line);
void add_report_command(CLI::App& app, CommandLine& line);
void add_compare_command(CLI::App& app, CommandLine& line);

// The text of an option that counts: digits only.
CLI::Validator whole_number();

// Parses, runs, and turns every error into a message on standard error and an exit code. `arguments` excludes
// the program's name.
int run_command_line(std::vector<std::string> arguments);

}  // namespace trueblade
