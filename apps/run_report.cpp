#include "apps/run_report.h"

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "apps/run_folder.h"
#include "apps/scenario.h"
#include "geometry/atomic_file.h"
#include "geometry/error.h"
#include "inspection/result_csv.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

Viewpoint viewpoint_of(const Scenario& scenario, const Json& view) {
  return viewpoint_of_view(view.at("view").get<std::string>(), scenario.machine.geometry,
                           view.at("theta_rad").get<double>(), pose_of(view.at("pose")));
}

void attempt(std::vector<std::string>& missing, const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& failure) {
    missing.emplace_back(failure.what());
  }
}

}  // namespace

std::vector<std::string> write_run_report(const std::filesystem::path& folder, const Part* part) {
  Report report;
  report.result = read_result(folder);
  report.part = part;
  std::optional<Scenario> scenario;
  const std::filesystem::path resolved = folder / "resolved.yaml";
  if (std::filesystem::exists(resolved)) {
    report.scenario = text_of(resolved);
    attempt(report.missing, [&] { scenario = read_scenario(resolved); });
  } else if (!part) {
    report.missing.push_back(
        fmt::format("{}: no such file, so that the part is not known", resolved.string()));
  }
  std::optional<Part> made;
  if (!part && scenario)
    attempt(report.missing, [&] {
      made = make_part(scenario->part);
      report.part = &*made;
    });
  try {
    for (const Json& view : report.result.at("views")) {
      if (!view.at("failure").is_null()) continue;
      attempt(report.missing, [&] {
        report.clouds.push_back(read_cloud(folder, view.at("view").get<std::string>()));
        if (scenario) report.clouds.back().viewpoint = viewpoint_of(*scenario, view);
      });
    }
    write_report_html(folder / "report.html", report);
    write_text_atomically(folder / "statistics.csv", statistics_csv(report.result));
    write_text_atomically(folder / "features.csv", features_csv(report.result));
  } catch (const Json::exception& failure) {
    throw InputError(fmt::format("{}: {}", (folder / "result.json").string(), failure.what()));
  }
  return report.missing;
}

}  // namespace trueblade
