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

  // NaN where a number is in one run only.
  double difference() const {
    return before.is_number() && after.is_number() ? after.get<double>() - before.get<double>()
                                                   : std::nan("");
  }
  bool is_same() const { return before == after; }
  // More than three standard uncertainties.
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

// Notes what only one of the runs has.
void note_unmatched(const std::string& prefix, const char* key, const Json& a, const Json& b,
                    std::vector<std::string>& notes) {
  const auto note = [&](const Json& list, const Json& other, const char* run) {
    for (const Json& entry : list)
      if (!find_by(other, key, entry.at(key)))
        notes.push_back(fmt::format("{}{} is only in the {} run", prefix,
                                    entry.at(key).is_string()
                                        ? entry.at(key).get<std::string>()
                                        : fmt::format("{:g} mm", entry.at(key).get<double>()),
                                    run));
  };
  note(a, b, "first");
  note(b, a, "second");
}

// Where the second pose puts the point that the first brings to its pivot, and how it is turned.
void compare_poses(const std::string& name, const Json& a, const Json& b, std::vector<Change>& changes) {
  const Json& pivot = a.at("pose_covariance_pivot_mm");
  if (pivot.at(0).is_null()) return;
  const Vec6 step = step_between(pose_of(a.at("pose")), pose_of(b.at("pose")), vector_of(pivot));
  const char* const kNames[] = {"pose, rotation x", "pose, rotation y", "pose, rotation z",
                                "pose, centroid x", "pose, centroid y", "pose, centroid z"};
  for (std::size_t k = 0; k < 6; ++k) {
    const Json &u = a.at("pose_covariance").at(k).at(k), &v = b.at("pose_covariance").at(k).at(k);
    const double uncertainty =
        u.is_number() && v.is_number() ? std::sqrt(std::max(0.0, u.get<double>() + v.get<double>())) : 0.0;
    changes.push_back(
        {name, kNames[k], k < 3 ? "rad" : "mm", 0.0, step[static_cast<Eigen::Index>(k)], uncertainty});
  }
}

void compare_registrations(const std::string& name, const Json& a, const Json& b,
                           std::vector<Change>& changes, std::vector<std::string>& notes) {
  for (const char* key : {"iterations", "inliers", "outliers"})
    changes.push_back({name, key, "", a.at(key), b.at(key)});
  if (a.at("termination") != b.at("termination"))
    notes.push_back(fmt::format("{}: {} in the first run, {} in the second", name,
                                a.at("termination").get<std::string>(),
                                b.at("termination").get<std::string>()));
  compare_poses(name, a, b, changes);
}

// The pose of one thing (`of`) against another, component by component.
void compare_differences(const std::string& prefix, const Json& a, const Json& b,
                         std::vector<Change>& changes, std::vector<std::string>& notes) {
  note_unmatched(prefix, "of", a, b, notes);
  for (const Json& difference : a) {
    const std::string name = prefix + difference.at("of").get<std::string>();
    const Json* other = find_by(b, "of", difference.at("of"));
    if (!other) continue;
    for (const auto& component : difference.at("components").items()) {
      const Json& same = other->at("components").at(component.key());
      const bool is_angle = component.key().ends_with("_rad");
      changes.push_back({name, component.key(), is_angle ? "rad" : "mm", component.value().at("value"),
                         same.at("value"), uncertainty_of(component.value(), same)});
    }
  }
}

void compare_views(const Json& a, const Json& b, std::vector<Change>& changes,
                   std::vector<std::string>& notes) {
  note_unmatched("view ", "view", a.at("views"), b.at("views"), notes);
  for (const Json& view : a.at("views")) {
    const std::string name = "view " + view.at("view").get<std::string>();
    const Json* other = find_by(b.at("views"), "view", view.at("view"));
    if (!other) continue;
    for (const char* key :
         {"planned", "points", "out_of_range", "missed", "low_signal", "left_out_by_report"})
      changes.push_back({name, key, "", view.at("samples").at(key), other->at("samples").at(key)});
    if (!view.at("failure").is_null() || !other->at("failure").is_null()) {
      notes.push_back(name + (view.at("failure").is_null()     ? " failed in the second run"
                              : other->at("failure").is_null() ? " failed in the first run"
                                                               : " failed in both runs"));
      continue;
    }
    compare_registrations(name, view, *other, changes, notes);
    changes.push_back({name, "initial_rms_mm", "mm", view.at("initial_rms_mm"), other->at("initial_rms_mm")});
    changes.push_back(
        {name, "time of the scan", "s", view.at("time_s").at("scan"), other->at("time_s").at("scan")});
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
  const Json &joint = a.at("joint"), &other_joint = b.at("joint");
  if (joint.is_null() != other_joint.is_null())
    notes.push_back(
        fmt::format("all views together: only in the {} run", joint.is_null() ? "second" : "first"));
  if (joint.is_null() || other_joint.is_null()) return;
  compare_registrations("all views", joint, other_joint, changes, notes);
  changes.push_back({"all views", "rms_mm", "mm", joint.at("deviations").at("rms_mm"),
                     other_joint.at("deviations").at("rms_mm")});
  compare_differences("against first: ", joint.at("between_views"), other_joint.at("between_views"), changes,
                      notes);
}

void compare_features(const Json& a, const Json& b, std::vector<Change>& changes,
                      std::vector<std::string>& notes) {
  note_unmatched("section ", "height_mm", a.at("sections"), b.at("sections"), notes);
  for (const Json& section : a.at("sections")) {
    const Json* other = find_by(b.at("sections"), "height_mm", section.at("height_mm"));
    if (!other) continue;
    const std::string name = fmt::format("section {:g} mm", section.at("height_mm").get<double>());
    for (const Json& feature : section.at("features"))
      if (const Json* same = find_by(other->at("features"), "name", feature.at("name")))
        changes.push_back({name, feature.at("name").get<std::string>(), feature.at("unit").get<std::string>(),
                           feature.at("measured"), same->at("measured"), uncertainty_of(feature, *same)});
  }
  compare_differences("group ", a.at("offsets"), b.at("offsets"), changes, notes);
  note_unmatched("profile ", "name", a.at("profiles"), b.at("profiles"), notes);
  for (const Json& profile : a.at("profiles")) {
    const Json* other = find_by(b.at("profiles"), "name", profile.at("name"));
    if (!other) continue;
    const std::string name = "profile " + profile.at("name").get<std::string>();
    const Json u = profile.value("standard_uncertainty_mm", Json()),
               v = other->value("standard_uncertainty_mm", Json());
    changes.push_back({name, "profile_mm", "mm", profile.at("profile_mm"), other->at("profile_mm"),
                       u.is_number() && v.is_number() ? std::hypot(u.get<double>(), v.get<double>()) : 0.0});
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
  return value.is_number_integer() ? value.dump() : fmt::format("{:.6f}", value.get<double>());
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
  std::stable_partition(changes.begin(), changes.end(), [](const Change& c) { return c.is_clear(); });
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
  fmt::print("{:<24} {:<40} {:<4} {:>12} {:>12} {:>12}\n", "What", "Number", "Unit", "First", "Second",
             "Change");
  for (const Change& c : changes) {
    if (c.is_same()) continue;
    const double difference = c.difference();
    fmt::print("{:<24} {:<40} {:<4} {:>12} {:>12} {:>12}{}\n", c.what, c.name, c.unit, shown(c.before),
               shown(c.after), std::isnan(difference) ? "-" : fmt::format("{:+.6f}", difference),
               c.is_clear() ? "  more than 3 standard uncertainties" : "");
  }
  const auto same =
      std::count_if(changes.begin(), changes.end(), [](const Change& c) { return c.is_same(); });
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
Numbers that are in both runs and differ, view by view, section by section; first those that changed by more than three
standard uncertainties. Lengths in mm, angles in rad. A pose is that of
the second run relative to the first, about the scan's centroid: it tells how the part stood, not what it is.

Example:
  trueblade compare results/runs/monday results/runs/friday)");
  command->callback([options, &line] {
    line.chosen = [options, &line] { return compare(options->first, options->second, line.json); };
  });
}

}  // namespace trueblade
