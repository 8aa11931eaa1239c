#include "inspection/result_csv.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

// Texts are quoted, with quotes doubled (RFC 4180).
std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string quoted = "\"";
  for (const char c : value.get<std::string>()) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string row(const std::vector<Json>& cells) {
  std::string line;
  for (const Json& value : cells) line += (line.empty() ? "" : ",") + cell(value);
  return line + "\r\n";
}

constexpr const char* kStatistics[] = {
    "points",           "outliers",        "min_mm", "max_mm", "mean_mm", "rms_mm", "standard_deviation_mm",
    "mean_positive_mm", "mean_negative_mm"};
constexpr const char* kCounts[] = {"percent_within", "percent_over", "percent_under", "outliers_outside"};

// Against the facet model; of the points alone there is no second number.
constexpr const char* kFromFacets[] = {
    "min_mm", "max_mm", "mean_mm", "rms_mm", "standard_deviation_mm", "mean_positive_mm", "mean_negative_mm"};

std::string statistics_row(const Json& view, const Json& surface, const Json& name, const Json& statistics,
                           const Json& tolerance, const Json& from_facets) {
  std::vector<Json> cells{view, surface, name};
  for (const char* key : kStatistics) cells.push_back(statistics.at(key));
  for (const char* key : kCounts) cells.push_back(tolerance.is_null() ? Json(nullptr) : tolerance.at(key));
  for (const char* key : kFromFacets) cells.push_back(from_facets.value(key, Json(nullptr)));
  return row(cells);
}

std::string differences(const char* kind, const Json& list) {
  std::string text;
  for (const Json& difference : list)
    for (const auto& component : difference.at("components").items()) {
      const std::string name = component.key();
      text += row({kind, difference.at("of"), name.substr(0, name.rfind('_')),
                   name.substr(name.rfind('_') + 1), 0.0, component.value().at("value"),
                   component.value().at("value"), component.value().at("standard_uncertainty"), nullptr,
                   nullptr, nullptr, nullptr, difference.at("from"), nullptr, nullptr});
    }
  return text;
}

}  // namespace

std::string statistics_csv(const Json& result) {
  std::string text = "view,surface,name";
  for (const char* key : kStatistics) text += fmt::format(",{}", key);
  for (const char* key : kCounts) text += fmt::format(",{}", key);
  for (const char* key : kFromFacets) text += fmt::format(",from_facets_{}", key);
  text += "\r\n";
  for (const Json& view : result.at("views")) {
    text += statistics_row(view.at("view"), nullptr, nullptr, view.at("deviations"), view.at("tolerance"),
                           view.at("deviations_from_facets"));
    for (const Json& surface : view.at("per_surface"))
      text +=
          statistics_row(view.at("view"), surface.at("surface"), surface.at("name"), surface,
                         surface.at("tolerance"), surface.value("deviations_from_facets", Json::object()));
  }
  return text;
}

std::string features_csv(const Json& result) {
  std::string text =
      "kind,where,name,unit,nominal,measured,deviation,standard_uncertainty,lower_limit,upper_limit,"
      "guard_band,decision,relative_to,method,rejection_guard_band\r\n";
  for (const Json& section : result.at("sections"))
    for (const Json& feature : section.at("features"))
      text += row({"section", section.at("height_mm"), feature.at("name"), feature.at("unit"),
                   feature.at("nominal"), feature.at("measured"), feature.at("deviation"),
                   feature.at("standard_uncertainty"), nullptr, nullptr, nullptr, nullptr, nullptr,
                   feature.at("measured").is_null() ? feature.at("reason") : feature.at("method"), nullptr});
  for (const Json& profile : result.at("profiles"))
    text += row({"profile", profile.at("name"), "profile", "mm", 0.0, profile.at("profile_mm"),
                 profile.at("profile_mm"), profile.value("standard_uncertainty_mm", Json(nullptr)),
                 profile.at("tolerance_mm").at(0), profile.at("tolerance_mm").at(1), profile.at("guard_mm"),
                 profile.at("conformity"), nullptr, profile.at("reason"),
                 profile.value("rejection_guard_mm", Json(nullptr))});
  text += differences("offset", result.at("offsets"));
  if (!result.at("joint").is_null())
    text += differences("between views", result.at("joint").at("between_views"));
  return text;
}

}  // namespace trueblade
