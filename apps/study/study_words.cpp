#include "apps/study/study_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

// The unit of a number without one is 1, which is not said.
std::string with_unit(const Json& value, const Json& q) {
  const auto unit = q["unit"].get<std::string>();
  const std::string number = value.is_number() ? fmt::format("{:.3g}", value.get<double>()) : "-";
  return unit == "1" ? number : number + " " + unit;
}

// The headline of a case: a case whose views have other names (all of them together) has the same quantity of
// its own first view.
std::optional<std::string> headline_of(const Json& item, const std::string& headline) {
  if (!item.contains("quantities")) return std::nullopt;
  const Json& quantities = item["quantities"];
  const auto has_value = [&](const std::string& name) {
    return quantities.contains(name) && quantities[name].contains("mean");
  };
  if (has_value(headline)) return headline;
  const std::string without_view = headline.substr(headline.find('.') + 1);
  for (const auto& [name, statement] : quantities.items())
    if (name.substr(name.find('.') + 1) == without_view && has_value(name)) return name;
  return std::nullopt;
}

bool has_only_failures(const Json& item) {
  std::uint64_t failed = 0;
  for (const Json& failure : item["failures"]) failed += failure["count"].get<std::uint64_t>();
  return failed == item["trials"].get<std::uint64_t>();
}

std::string sentence(const Json& item, const std::string& headline, double coverage_probability) {
  auto name = item["name"].get<std::string>();
  if (has_only_failures(item)) return name + ": no trial has a result";
  const auto own_headline = headline_of(item, headline);
  if (!own_headline) return fmt::format("{}: too few trials have a value of {}", name, headline);
  if (*own_headline != headline) name += fmt::format(" ({})", *own_headline);
  const Json& q = item["quantities"][*own_headline];
  const Json& ends = q["shortest_interval"];
  return fmt::format("{}: {:.4g} % of the trials lie from {} to {}; mean {}, standard uncertainty {}", name,
                     100.0 * coverage_probability, with_unit(ends[0], q), with_unit(ends[1], q),
                     with_unit(q["mean"], q), with_unit(q["standard_uncertainty"], q));
}

bool has_bound(const Json& document) {
  const Json& cases = document["cases"];
  return std::any_of(cases.begin(), cases.end(), [](const Json& item) {
    if (!item.contains("theory")) return false;
    const Json& theory = item["theory"];
    return std::any_of(theory.begin(), theory.end(),
                       [](const Json& of_view) { return of_view.contains("components"); });
  });
}

bool has_sobol_indices(const Json& document) {
  const Json& budget = document["budget"];
  return std::any_of(budget.begin(), budget.end(), [](const Json& of_quantity) {
    const Json& sources = of_quantity["sources"];
    return std::any_of(sources.begin(), sources.end(), [](const Json& row) { return row.contains("total"); });
  });
}

}  // namespace

Json answer_in_words(const Json& document) {
  Json answer = Json::array();
  for (const Json& item : document["cases"])
    if (!item.contains("for_budget"))
      answer.push_back(sentence(item, document["headline"].get<std::string>(),
                                document["coverage_probability"].get<double>()));
  return answer;
}

std::string advice_in_words(const std::vector<std::string>& sources) {
  if (sources.size() == 1) return fmt::format("improve {} first", sources.front());
  return fmt::format("improve {} or {} first (they cannot be told apart with these trials)",
                     fmt::join(sources.begin(), sources.end() - 1, ", "), sources.back());
}

Json terms_in_words(const Json& document) {
  Json terms{
      {"standard uncertainty (u)",
       "standard deviation of a quantity over the trials: how much one inspection scatters about the mean"},
      {"bias",
       "mean error over the trials, registered or measured minus true; it stands beside u and is not in it"},
      {"coverage interval",
       "holds the stated share of the trials (the coverage probability): the symmetric one leaves equal "
       "shares "
       "beyond both ends, the shortest one is the shortest that does"},
      {"standard error", "how well the trials determine a mean or bias: u / sqrt(values)"}};
  if (has_bound(document))
    terms["Cramer-Rao bound"] =
        "the least u of the pose that any unbiased registration of the same points can have, with their "
        "noise "
        "alone; u / bound = 1: nothing is given away";
  if (has_sobol_indices(document))
    terms["Sobol index"] =
        "share of a source in the variance (u squared): first order, what would go if the source alone were "
        "known; total, what would stay if all others were";
  return terms;
}

}  // namespace trueblade
