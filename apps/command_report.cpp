#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.h"
#include "apps/run_report.h"

namespace trueblade {

void add_report_command(CLI::App& app, CommandLine& line) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("report", "Build the report of a run again from what its folder holds");
  command->add_option("run_folder", *folder, "Folder of an inspection")->required()->type_name("DIR");
  command->footer(R"(
Writes report.html, statistics.csv and features.csv into the folder. What the folder lacks is named in the report.

Example:
  trueblade report results/runs/turbine_blade_front)");
  command->callback([folder, &line] {
    line.chosen = [folder] {
      const std::vector<std::string> missing = write_run_report(*folder, nullptr);
      for (const std::string& message : missing) spdlog::error("missing: {}", message);
      fmt::print("{}\n", (std::filesystem::path(*folder) / "report.html").string());
      return missing.empty() ? ExitCode::done : ExitCode::bad_input;
    };
  });
}

}  // namespace trueblade
