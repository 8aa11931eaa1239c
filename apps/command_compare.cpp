#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "apps/command.h"
#include "apps/run_folder.h"
#include "geometry/error.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

// One number of both runs.
struct Change {
  std::string what, name, unit;
  Json before, after;
  double uncertainty = 0.0;  // standard, of the difference; 0: not known

  double difference() const {
    return before.is_number() && after.is_number() ? after.get<double>() - before.get<double>()
                                                   : std::nan("");
  }
  bool is_clear() const { return uncertainty > 0.0 && std::abs(difference()) > 3.0 * uncertainty; }
};

const Json* find_by(const Json& list, const char* key, const Json& value) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Json& entry) { return entry.at(key) == value; });
  return found == list.end() ? nullptr : &*found;
}

double uncertainty_of(const Json& a, const Json& b) {
  const Json &u = a.at("standard_uncertainty"), &v = b.at("standard_uncertainty");
  return u.is_number() && v.is_number() ? std::hypot(u.get<double>(), v.get<double>()) : 0.0;
}

void compare_views(const Json& a, const Json& b, std::vector<Change>& changes,
                   std::vector<std::string>& notes) {
  for (const Json& view : a.at("views")) {
    const std::string name = "view " + view.at("view").get<std::string>();
    const Json* other = find_by(b.at("views"), "view", view.at("view"));
    if (!other) {
      notes.push_back(name + " is only in the first run");
      continue;
    }
    changes.push_back({name, "points", "", view.at("points"), other->at("points")});
    for (const char* key : {"rms_mm", "min_mm", "max_mm", "mean_mm", "standard_deviation_mm"})
      changes.push_back({name, key, "mm", view.at("deviations").at(key), other->at("deviations").at(key)});
    if (!view.at("tolerance").is_null() && !other->at("tolerance").is_null())
      changes.push_back({name, "percent_within", "%", view.at("tolerance").at("percent_within"),
                         other->at("tolerance").at("percent_within")});
    for (const Json& surface : view.at("per_surface"))
      if (const Json* same = find_by(other->at("per_surface"), "surface", surface.at("surface")))
        changes.push_back({name, "surface " + surface.at("name").get<std::string>() + " mean_mm", "mm",
                           surface.at("mean_mm"), same->at("mean_mm")});
  }
  for (const Json& view : b.at("views"))
    if (!find_by(a.at("views"), "view", view.at("view")))
      notes.push_back("view " + view.at("view").get<std::string>() + " is only in the second run");
}

void compare_features(const Json& a, const Json& b, std::vector<Change>& changes,
                      std::vector<std::string>& notes) {
  for (const Json& section : a.at("sections")) {
    const Json* other = find_by(b.at("sections"), "height_mm", section.at("height_mm"));
    const std::string name = fmt::format("section {:g} mm", section.at("height_mm").get<double>());
    if (!other) {
      notes.push_back(name + " is only in the first run");
      continue;
    }
    for (const Json& feature : section.at("features"))
      if (const Json* same = find_by(other->at("features"), "name", feature.at("name")))
        changes.push_back({name, feature.at("name").get<std::string>(), feature.at("unit").get<std::string>(),
                           feature.at("measured"), same->at("measured"), uncertainty_of(feature, *same)});
  }
  for (const Json& offset : a.at("offsets")) {
    const Json* other = find_by(b.at("offsets"), "of", offset.at("of"));
    if (!other) continue;
    for (const auto& component : offset.at("components").items()) {
      const Json& same = other->at("components").at(component.key());
      changes.push_back({"group " + offset.at("of").get<std::string>(), component.key(), "",
                         component.value().at("value"), same.at("value"),
                         uncertainty_of(component.value(), same)});
    }
  }
  for (const Json& profile : a.at("profiles")) {
    const Json* other = find_by(b.at("profiles"), "name", profile.at("name"));
    if (!other) continue;
    const std::string name = "profile " + profile.at("name").get<std::string>();
    changes.push_back({name, "profile_mm", "mm", profile.at("profile_mm"), other->at("profile_mm")});
    if (profile.at("conformity") != other->at("conformity"))
      notes.push_back(fmt::format("{}: was {}, is {}", name, profile.at("conformity").get<std::string>(),
                                  other->at("conformity").get<std::string>()));
  }
}

void note_recipes(const Json& a, const Json& b, std::vector<std::string>& notes) {
  for (const auto& fact : a.at("run").items())
    if (b.at("run").contains(fact.key()) && b.at("run").at(fact.key()) != fact.value())
      notes.push_back(fmt::format("{}: {} in the first run, {} in the second", fact.key(),
                                  fact.value().dump(), b.at("run").at(fact.key()).dump()));
}

std::string shown(const Json& value) {
  if (!value.is_number()) return "-";
  return value.is_number_integer() ? value.dump() : fmt::format("{:.5f}", value.get<double>());
}

int compare(const std::string& first, const std::string& second, bool json) {
  const Json a = read_result(first), b = read_result(second);
  std::vector<Change> changes;
  std::vector<std::string> notes;
  try {
    note_recipes(a, b, notes);
    compare_views(a, b, changes, notes);
    compare_features(a, b, changes, notes);
  } catch (const Json::exception& failure) {
    throw InputError(fmt::format("{} or {}: {}", first, second, failure.what()));
  }
  if (json) {
    Json list = Json::array();
    for (const Change& c : changes)
      list.push_back({{"what", c.what},
                      {"name", c.name},
                      {"before", c.before},
                      {"after", c.after},
                      {"difference", c.difference()},  // NaN is written as null
                      {"standard_uncertainty", c.uncertainty > 0.0 ? Json(c.uncertainty) : Json(nullptr)}});
    fmt::print("{}\n", Json{{"notes", notes}, {"changes", list}}.dump(2));
    return ExitCode::done;
  }
  for (const std::string& note : notes) fmt::print("{}\n", note);
  fmt::print("{:<18} {:<40} {:>12} {:>12} {:>12}\n", "What", "Number", "First", "Second", "Change");
  for (const Change& c : changes) {
    if (!(std::abs(c.difference()) > 0.0)) continue;
    fmt::print("{:<18} {:<40} {:>12} {:>12} {:>+12.5f}{}\n", c.what, c.name, shown(c.before), shown(c.after),
               c.difference(), c.is_clear() ? "  more than 3 standard uncertainties" : "");
  }
  const auto same =
      std::count_if(changes.begin(), changes.end(), [](const Change& c) { return c.difference() == 0.0; });
  fmt::print("{} of {} numbers are the same\n", same, changes.size());
  return ExitCode::done;
}

}  // namespace

void add_compare_command(CLI::App& app, CommandLine& line) {
  struct Options {
    std::string first, second;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compare", "What changed between two inspections");
  command->add_option("run_a", options->first, "Folder of the first run")->required()->type_name("DIR");
  command->add_option("run_b", options->second, "Folder of the second run")->required()->type_name("DIR");
  command->add_flag("--json", line.json, "Print the changes as JSON on standard output");
  command->footer(R"(
Numbers that are in both runs and differ, view by view, section by section. Lengths in mm, angles in rad.

Example:
  trueblade compare results/runs/monday results/runs/friday)");
  command->callback([options, &line] {
    line.chosen = [options, &line] { return compare(options->first, options->second, line.json); };
  });
}

}  // namespace trueblade
