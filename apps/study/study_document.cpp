#include "apps/study/study_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/study/influences.h"
#include "apps/study/part_quantities.h"
#include "apps/study/study_words.h"
#include "apps/version.h"
#include "inspection/statistics.h"
#include "sim/study/paired.h"
#include "sim/study/sensitivity.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;
using Cell = TrialStore::Cell;

constexpr std::size_t kHistogramBins = 40;
constexpr std::size_t kScatterPoints = 1000;
constexpr const char* kSizes[] = {".rotation_error_rad",     ".translation_error_mm",
                                  ".deviation_error_rms_mm", "_largest_mm",
                                  "_largest_error_mm",       ".normalised_error_squared"};

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json interval(const CoverageInterval& ends) {
  return {number(ends.low), number(ends.high)};
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

// What the study keeps of these trials. One quantity is read at a time, so that a long study takes hardly
// more memory than a short one.
struct Rows {
  const StudyModel& model;
  const TrialStore& store;
  TrialRange trials;

  std::optional<Cell> find(std::uint32_t case_number, const std::string& name) const {
    for (std::size_t k = 0; k < model.quantities().size(); ++k)
      if (model.quantities()[k].name == name) return Cell{case_number, k};
    return std::nullopt;
  }

  // Calls `row` for the trials that have a value in all cells.
  void for_each_common(std::span<const Cell> cells,
                       const std::function<void(std::span<const double>)>& row) const {
    store.for_each_value(cells, trials, [&](std::uint64_t, std::span<const double> values) {
      if (all_finite(values)) row(values);
    });
  }

  // The same as one vector for each cell.
  std::vector<std::vector<double>> common_values(std::span<const Cell> cells) const {
    std::vector<std::vector<double>> values(cells.size());
    for_each_common(cells, [&](std::span<const double> row) {
      for (std::size_t c = 0; c < row.size(); ++c) values[c].push_back(row[c]);
    });
    return values;
  }

  std::vector<double> values(const Cell& cell) const { return common_values({&cell, 1}).front(); }
};

// Standard error of a standard deviation, for any distribution: sqrt(m4 - s^4) / (2 s sqrt(M)).
double uncertainty_error(const std::vector<double>& values, const Statement& s) {
  double fourth = 0.0;
  for (const double value : values) fourth += std::pow(value - s.mean, 4);
  const auto m = static_cast<double>(values.size());
  const double variance = s.standard_uncertainty * s.standard_uncertainty;
  if (variance == 0.0) return 0.0;
  return std::sqrt(std::max(0.0, fourth / m - variance * variance) / m) / (2.0 * s.standard_uncertainty);
}

Json histogram(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (*low == *high) return nullptr;
  const Histogram h = histogram_of(values, {}, *low, *high, kHistogramBins);
  return {{"from", *low}, {"to", *high}, {"counts", h.counts}};
}

// Registered or measured minus true, with its sign: its mean is a bias. The mean of a size, such as the angle
// between two poses, is above zero however good the measurement; the largest error of many takes either sign
// by chance, and its mean is near zero however bad.
bool is_signed_error(const Quantity& quantity) {
  if (quantity.name.find("error_") == std::string::npos) return false;
  return std::none_of(std::begin(kSizes), std::end(kSizes),
                      [&](const char* size) { return quantity.name.ends_with(size); });
}

Json statement(const Quantity& quantity, const std::vector<double>& values, double probability) {
  Json json{{"unit", quantity.unit}, {"description", quantity.description}, {"values", values.size()}};
  if (values.size() < least_trials(probability)) return json;
  const Statement s = statement_of(values, probability);
  json["mean"] = s.mean;
  json["standard_uncertainty"] = s.standard_uncertainty;
  json["standard_error_of_mean"] = s.standard_uncertainty / std::sqrt(static_cast<double>(s.trials));
  json["standard_error_of_uncertainty"] = uncertainty_error(values, s);
  if (is_signed_error(quantity)) json["bias"] = s.mean;  // the truth is zero
  json["symmetric_interval"] = interval(s.symmetric);
  json["shortest_interval"] = interval(s.shortest);
  json["histogram"] = histogram(values);
  return json;
}

// Trials that have a result, but not this quantity; `study show --trial` tells why.
Json without_value(const Rows& rows, const Cell& cell) {
  Json json{{"count", 0}};
  std::size_t count = 0;
  rows.store.for_each_value({&cell, 1}, rows.trials, [&](std::uint64_t trial, std::span<const double> value) {
    if (!std::isfinite(value[0]) && count++ == 0) json["first_trial"] = trial;
  });
  json["count"] = count;
  return json;
}

Json failures(const TrialStore& store, std::uint32_t case_number, const TrialRange& trials) {
  Json list = Json::array();
  for (const auto& failure : store.failures(case_number, trials))
    list.push_back(
        {{"reason", failure.failure}, {"count", failure.count}, {"first_trial", failure.first_trial}});
  return list;
}

Json settings(const std::vector<FieldValue>& set) {
  Json json = Json::object();
  for (const FieldValue& item : set) json[item.field] = item.value;
  return json;
}

// Distribution function of chi-square with 6 degrees of freedom, and its quantile by bisection.
double chi_square_6(double x) {
  return 1.0 - std::exp(-0.5 * x) * (1.0 + 0.5 * x + 0.125 * x * x);
}

double chi_square_6_quantile(double probability) {
  double low = 0.0, high = 1000.0;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (chi_square_6(middle) < probability ? low : high) = middle;
  }
  return high;
}

double root_mean_square(const Rows& rows, const Cell& cell) {
  double squares = 0.0, count = 0.0;
  rows.for_each_common({&cell, 1}, [&](std::span<const double> value) {
    squares += value[0] * value[0];
    ++count;
  });
  return count > 0.0 ? std::sqrt(squares / count) : kNoValue;
}

// Cramer-Rao bound beside the spread, and how often the reported covariance covers the truth.
Json theory(const Rows& rows, std::uint32_t case_number, const std::string& view, double probability) {
  Json json;
  for (const char* component : {"rotation_x_rad", "rotation_y_rad", "rotation_z_rad", "translation_x_mm",
                                "translation_y_mm", "translation_z_mm"}) {
    const auto error = rows.find(case_number, fmt::format("{}.error_{}", view, component));
    const auto reported = rows.find(case_number, fmt::format("{}.u_{}", view, component));
    const auto bound = rows.find(case_number, fmt::format("{}.bound_{}", view, component));
    if (!error || !reported || !bound) continue;
    const std::vector<double> errors = rows.values(*error);
    if (errors.size() < least_trials(probability)) continue;
    const double spread = statement_of(errors, probability).standard_uncertainty;
    const double least = root_mean_square(rows, *bound);
    json["components"].push_back({{"component", component},
                                  {"spread", spread},
                                  {"cramer_rao_bound", number(least)},
                                  {"spread_to_bound", number(spread / least)},
                                  {"reported", number(root_mean_square(rows, *reported))}});
  }
  if (const auto cell = rows.find(case_number, view + ".normalised_error_squared")) {
    const double limit = chi_square_6_quantile(probability);
    std::size_t count = 0, covered = 0;
    rows.for_each_common({&*cell, 1}, [&](std::span<const double> value) {
      ++count;
      covered += value[0] <= limit;
    });
    if (count == 0) return json;
    json["coverage_of_reported_covariance"] = {
        {"stated", probability},
        {"observed", static_cast<double>(covered) / static_cast<double>(count)},
        {"confidence_interval_95", interval(share_interval(covered, count, 0.95))},
        {"trials", count}};
  }
  return json;
}

// Pose errors of the first trials and the ellipse of the mean reported covariance, for the plot.
Json scatter(const Rows& rows, std::uint32_t case_number, const std::string& view) {
  Json json;
  for (const auto& [first, second, pair] :
       {std::tuple{"x", "y", "xy"}, std::tuple{"x", "z", "xz"}, std::tuple{"y", "z", "yz"}}) {
    std::vector<Cell> cells;
    for (const std::string& name :
         {fmt::format("error_translation_{}_mm", first), fmt::format("error_translation_{}_mm", second),
          fmt::format("u_translation_{}_mm", first), fmt::format("u_translation_{}_mm", second),
          fmt::format("reported_correlation_translation_{}", pair)})
      if (const auto cell = rows.find(case_number, view + "." + name)) cells.push_back(*cell);
    if (cells.size() != 5) return nullptr;
    double xx = 0.0, yy = 0.0, xy = 0.0, count = 0.0;
    Json points = Json::array();
    rows.for_each_common(cells, [&](std::span<const double> value) {
      const double ux = value[2], uy = value[3], correlation = value[4];
      xx += ux * ux;
      yy += uy * uy;
      xy += ux * uy * correlation;
      ++count;
      if (points.size() < kScatterPoints) points.push_back({value[0], value[1]});
    });
    if (points.empty()) return nullptr;
    json.push_back({{"x", first},
                    {"y", second},
                    {"mean_reported_covariance", {xx / count, xy / count, yy / count}},
                    {"points", points}});
  }
  return json;
}

// Running mean and standard uncertainty of the headline over the trials.
Json convergence(const std::vector<double>& values) {
  Json json = Json::array();
  double mean = 0.0, squares = 0.0;
  std::size_t count = 0, next = 10;
  for (const double value : values) {
    ++count;
    const double before = value - mean;
    mean += before / static_cast<double>(count);
    squares += before * (value - mean);
    if (count != next && count != values.size()) continue;
    next = std::max(next + 1, static_cast<std::size_t>(1.1 * static_cast<double>(next)));
    if (count < 2) continue;
    const double u = std::sqrt(squares / static_cast<double>(count - 1));
    json.push_back({count, mean, u, u / std::sqrt(static_cast<double>(count))});
  }
  return json;
}

// The views that have a result in a case, in order.
std::vector<std::string> views_of(const Json& quantities) {
  std::vector<std::string> names;
  for (const auto& [name, quantity] : quantities.items()) {
    const std::string view = name.substr(0, name.find('.'));
    if (names.empty() || names.back() != view) names.push_back(view);
  }
  return names;
}

Json case_json(const StudySpec& study, const Rows& rows, std::uint32_t number) {
  const StudyModel& model = rows.model;
  const StudyCase& item = model.cases()[number];
  Json json{{"name", item.name},
            {"trials", rows.trials.size()},
            {"failures", failures(rows.store, number, rows.trials)}};
  if (item.role != StudyCase::Role::given) json["for_budget"] = true;
  if (item.views == ViewPolicy::together) json["views"] = "together";
  if (!item.set.empty()) json["set"] = settings(item.set);
  for (std::size_t k = 0; k < item.sweep_values.size(); ++k)
    json["sweep"][study.sweep[k].field] = item.sweep_values[k];
  const std::vector<Quantity> of_part = part_quantities(study, item.scenario);
  for (std::size_t k = 0; k < model.quantities().size(); ++k) {
    const Quantity& quantity = model.quantities()[k];
    const std::vector<double> values = rows.values({number, k});
    // What the scenario asks for is stated even if no trial could measure it.
    const bool asked_for = std::any_of(of_part.begin(), of_part.end(), [&](const Quantity& asked) {
      return quantity.name == "part." + asked.name;
    });
    if (values.empty() && !asked_for) continue;
    json["quantities"][quantity.name] = statement(quantity, values, study.coverage_probability);
    const Json absent = without_value(rows, {number, k});
    if (absent["count"] > 0) json["quantities"][quantity.name]["without_value"] = absent;
  }
  const std::size_t headline = quantity_number(model, study.headline);
  json["convergence"] = convergence(rows.values({number, headline}));
  for (const std::string& view : views_of(json.value("quantities", Json::object()))) {
    json["theory"][view] = theory(rows, number, view, study.coverage_probability);
    json["scatter"][view] = scatter(rows, number, view);
  }
  return json;
}

// Every given case against the first with the same values of the sweeps.
Json comparisons(const StudySpec& study, const Rows& rows) {
  const StudyModel& model = rows.model;
  Json list = Json::array();
  if (study.cases.size() < 2) return list;
  const std::vector<StudyCase>& cases = model.cases();
  for (std::uint32_t second = 1; second < cases.size(); ++second) {
    if (cases[second].role != StudyCase::Role::given) continue;
    std::uint32_t first = 0;
    while (cases[first].sweep_values != cases[second].sweep_values) ++first;
    if (first == second) continue;
    Json json{{"first", cases[first].name}, {"second", cases[second].name}};
    for (std::size_t k = 0; k < model.quantities().size(); ++k) {
      const auto values = rows.common_values(std::array{Cell{first, k}, Cell{second, k}});
      if (values[0].size() < 2) continue;
      const PairedDifference d = paired_difference(values[0], values[1], study.coverage_probability);
      json["quantities"][model.quantities()[k].name] = {{"unit", model.quantities()[k].unit},
                                                        {"pairs", d.pairs},
                                                        {"mean_difference", d.mean},
                                                        {"standard_error", d.standard_error},
                                                        {"confidence_interval", interval(d.confidence)},
                                                        {"significant", d.significant}};
    }
    list.push_back(json);
  }
  return list;
}

// The first source, and those within two standard errors of it. Sources share the same trials and the same
// variance, so that their errors are not independent: that of a difference is at most the sum.
std::vector<std::string> first_sources(const Json& sorted_rows, const std::string& by) {
  std::vector<std::string> sources;
  const Json& first = sorted_rows[0];
  for (const Json& row : sorted_rows) {
    const double error = first.value(by + "_error", 0.0) + row.value(by + "_error", 0.0);
    if (sources.empty() || first.value(by, 0.0) - row.value(by, 0.0) <= 2.0 * error)
      sources.push_back(row["source"]);
  }
  return sources;
}

// Contribution of every source to every quantity.
Json budget(const StudySpec& study, const Rows& rows_of_study) {
  const StudyModel& model = rows_of_study.model;
  Json json;
  if (study.budget.empty()) return json;
  const auto& cases = model.cases();
  const auto case_with = [&](StudyCase::Role role,
                             const std::string& source) -> std::optional<std::uint32_t> {
    for (std::uint32_t number = 0; number < cases.size(); ++number)
      if (cases[number].role == role && cases[number].source == source) return number;
    return std::nullopt;
  };
  const auto all_anew = case_with(StudyCase::Role::all_anew, "");
  for (std::size_t k = 0; k < model.quantities().size(); ++k) {
    Json rows = Json::array();
    for (const std::string& source : active_sources(cases[0].scenario)) {
      Json row{{"source", source}};
      if (const auto only = case_with(StudyCase::Role::only_source, source)) {
        const auto values = rows_of_study.values({*only, k});
        if (values.size() >= least_trials(study.coverage_probability)) {
          const Statement s = statement_of(values, study.coverage_probability);
          row["alone_standard_uncertainty"] = s.standard_uncertainty;
          row["alone_standard_uncertainty_error"] = uncertainty_error(values, s);
        }
      }
      const auto anew = case_with(StudyCase::Role::source_anew, source);
      if (all_anew && anew) {
        const auto values =
            rows_of_study.common_values(std::array{Cell{0, k}, Cell{*all_anew, k}, Cell{*anew, k}});
        if (values[0].size() >= 2) {
          const SobolIndex index = sobol_index(values[0], values[1], values[2]);
          row["first_order"] = index.first_order;
          row["first_order_error"] = index.first_order_error;
          row["total"] = index.total;
          row["total_error"] = index.total_error;
        }
      }
      if (row.size() > 1) rows.push_back(row);
    }
    if (rows.empty()) continue;
    const std::string by = all_anew ? "total" : "alone_standard_uncertainty";
    std::stable_sort(rows.begin(), rows.end(),
                     [&](const Json& a, const Json& b) { return a.value(by, 0.0) > b.value(by, 0.0); });
    const std::vector<std::string> first = first_sources(rows, by);
    json[model.quantities()[k].name] = {
        {"improve_first", first}, {"advice", advice_in_words(first)}, {"sources", rows}};
  }
  return json;
}

}  // namespace

nlohmann::ordered_json study_document(const StudySpec& study, const StudyModel& model, const StudyRun& run,
                                      const TrialStore& store) {
  Json json{{"kind", "virtual experiment"},
            {"study", study.name},
            {"description", study.description},
            {"scenario", study.scenario.filename().string()},
            {"set", settings(study.set)},
            {"program_version", program_version()},
            {"program_commit", program_commit()},
            {"generator", "Philox4x64-10, keyed by seed, trial and source"},
            {"method", "GUM Supplement 1 (JCGM 101:2008)"},
            {"seed", study.seed},
            {"first_trial", run.trials.begin},
            {"trials", run.trials.size()},
            {"coverage_probability", study.coverage_probability},
            {"headline", model.quantities()[quantity_number(model, study.headline)].name},
            {"rows_hash", fmt::format("{:016x}", store.rows_hash(run.trials))}};
  if (run.stopping) {
    const StudyRun::Stopping& s = *run.stopping;
    json["stopping"] = {{"quantity", s.quantity},
                        {"stable", s.stable},
                        {"blocks", s.blocks},
                        {"block_size", s.block_size},
                        {"numerical_tolerance", s.tolerance},
                        {"largest_twice_standard_error", s.largest_twice_standard_error},
                        {"trials_expected", s.trials_expected}};
  }
  json["influences"] = influences(study, model.cases());
  const Rows rows{model, store, run.trials};
  json["cases"] = Json::array();
  for (std::uint32_t number = 0; number < model.cases().size(); ++number)
    json["cases"].push_back(case_json(study, rows, number));
  json["comparisons"] = comparisons(study, rows);
  json["budget"] = budget(study, rows);
  json["answer"] = answer_in_words(json);
  json["terms"] = terms_in_words(json);
  return json;
}

}  // namespace trueblade
