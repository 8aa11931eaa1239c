#include "apps/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/nearest_word.h"
#include "apps/wrong_file.h"
#include "apps/yaml_reader.h"
#include "apps/yaml_writer.h"

namespace trueblade {
namespace {

void check_file_name(const std::string& key, const std::string& name) {
  const auto is_plain = [](unsigned char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           (letter >= '0' && letter <= '9') || letter == '_' || letter == '-';
  };
  // 100 leaves room for prefix and ending in the 255 bytes of a file name.
  if (name.empty() || name.size() > 100 || !std::all_of(name.begin(), name.end(), is_plain))
    throw InputError(
        fmt::format("{} is \"{}\", must be 1 to 100 letters, digits, _ or - (it names files)", key, name));
}

void fields(YamlFields& io, ViewSpec& view) {
  io.require("name");
  io.text("name", view.name);
  if (io.present("name")) io.check([&] { check_file_name("name", view.name); });
  io.angle("theta_deg", view.theta_rad, between(-360.0, 360.0));
}

void check_views(const std::vector<ViewSpec>& views) {
  if (views.empty()) throw InputError("views is empty, must hold at least one view");
  std::set<std::string> names;
  for (const ViewSpec& view : views) {
    if (!names.insert(view.name).second)
      throw InputError(fmt::format("views holds \"{}\" twice, names must differ", view.name));
  }
}

void fields(YamlFields& io, ViewAngleOptions& automatic) {
  io.angle("candidate_step_deg", automatic.candidate_step_rad, between(0.1, 180.0));
  io.integer("most_views", automatic.most_views, 1, 1000);
  io.number("least_gain", automatic.least_gain);
  io.integer("sample_count", automatic.sample_count, 100, 10'000'000);
  io.check([&] { automatic.validate(); });
}

void fields(YamlFields& io, ScanSpec& scan) {
  io.optional_map<ViewAngleOptions>(
      "automatic_views", scan.automatic_views,
      [](YamlFields& inner, ViewAngleOptions& automatic) { fields(inner, automatic); });
  if (!scan.automatic_views) io.require("views");
  if (io.reading())
    io.fail_unless(!(scan.automatic_views && io.present("views")),
                   "scan must have either views or automatic_views, not both");
  if (io.reading() || !scan.automatic_views)
    io.list<ViewSpec>("views", scan.views, [](YamlFields& inner, ViewSpec& view) { fields(inner, view); });
  io.number("spacing_mm", scan.spacing_mm, above(0.0));
  if (io.reading() || scan.standoff_spread_mm > 0.0)
    io.number("standoff_spread_mm", scan.standoff_spread_mm, at_least(0.0));
  io.integers("surfaces", scan.surfaces);
  io.angle("max_incidence_deg", scan.max_incidence_rad, between(1.0, 90.0));
  if (io.present("views") && !scan.automatic_views) io.check([&] { check_views(scan.views); });
}

void check_expected_views(const Scenario& scenario) {
  if (scenario.scan.automatic_views) return;  // named once they are chosen
  for (const auto& [name, expectation] : scenario.expect) {
    const bool known = std::any_of(scenario.scan.views.begin(), scenario.scan.views.end(),
                                   [&name = name](const ViewSpec& view) { return view.name == name; });
    if (!known) throw InputError(fmt::format("expect.{} is not among the views of scan", name));
  }
}

void check_expected_part(const Scenario& scenario) {
  const std::vector<std::string> known = part_quantities(scenario.inspection);
  for (const auto& [name, expectation] : scenario.expect_part) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto nearest = nearest_word(name, known);
    throw InputError(
        fmt::format("expect_part.{} is not among what the inspection block asks for{}; there are {}", name,
                    nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "", fmt::join(known, ", ")));
  }
}

void fields(YamlFields& io, Scenario& scenario, const std::filesystem::path& folder) {
  if (io.holds_foreign("scenario") && !io.present("part"))
    throw io.error("scenario", "this is a study, must be a scenario; `trueblade study` runs a study");
  io.text("name", scenario.name);
  io.text("description", scenario.description);
  io.integer("seed", scenario.seed, 0, std::numeric_limits<std::uint64_t>::max());
  io.integer("trial", scenario.trial, 0, std::numeric_limits<std::uint64_t>::max() / 2);
  io.require("part");
  io.map("part", [&](YamlFields& inner) { fields(inner, scenario.part, folder); });
  io.optional_map<PartSpec>("part_on_table", scenario.part_on_table,
                            [&](YamlFields& inner, PartSpec& part) { fields(inner, part, folder); });
  io.map("machine", [&](YamlFields& inner) { fields(inner, scenario.machine, folder); });
  io.require("scan");
  io.map("scan", [&](YamlFields& inner) { fields(inner, scenario.scan); });
  io.map("registration", [&](YamlFields& inner) { fields(inner, scenario.registration); });
  io.map("inspection", [&](YamlFields& inner) { fields(inner, scenario.inspection); });
  io.named<ViewExpectation>("expect", scenario.expect,
                            [](YamlFields& inner, ViewExpectation& view) { fields(inner, view); });
  if (io.reading() || !scenario.expect_error.empty()) io.text("expect_error", scenario.expect_error);
  io.named<PartExpectation>("expect_part", scenario.expect_part,
                            [](YamlFields& inner, PartExpectation& part) { fields(inner, part); });
  io.check([&] { check_file_name("name", scenario.name); });
}

}  // namespace

void drop_expectations(Scenario& scenario) {
  scenario.expect.clear();
  scenario.expect_part.clear();
  scenario.expect_error.clear();
}

Scenario read_scenario(const std::filesystem::path& file, const std::vector<YamlOverride>& overrides) {
  refuse_part_or_scan(file, "a scenario");
  Scenario scenario;
  scenario.name = file.stem().string();
  read_yaml(file, overrides, [&](YamlFields& io) {
    fields(io, scenario, file.parent_path());
    if (!overrides.empty()) drop_expectations(scenario);
    io.check([&] {
      check_expected_views(scenario);
      check_expected_part(scenario);
    });
  });
  return scenario;
}

std::string scenario_text(const Scenario& scenario) {
  Scenario copy = scenario;  // one list of fields serves both directions, so it takes what it could change
  return yaml_text([&](YamlFields& io) { fields(io, copy, {}); });
}

}  // namespace trueblade
