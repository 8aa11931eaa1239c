// The statement in words and tables. Who has nothing but this text must be able to defend it: what was
// varied, how often, by which method and program, what is covered and what is not.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/study/study_document.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

// Of running words; the tables end at 145.
constexpr std::size_t kWidth = 118;

std::string short_number(const Json& value) {
  return value.is_number() ? fmt::format("{:.4g}", value.get<double>()) : "-";
}

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string percent(const Json& share) {
  return fmt::format("{:.4g} %", 100.0 * share.get<double>());
}

// Words in lines, each of them indented, the second and further ones by two more.
std::string wrapped(const std::string& words, std::size_t indent = 0) {
  std::string text, line(indent, ' ');
  bool is_first_word = true;
  for (std::size_t begin = 0; begin < words.size();) {
    const std::size_t end = std::min(words.find(' ', begin), words.size());
    const std::string word = words.substr(begin, end - begin);
    begin = end + 1;
    if (!is_first_word && line.size() + 1 + word.size() > kWidth) {
      text += line + '\n';
      line = std::string(indent + 2, ' ') + word;
    } else {
      line += (is_first_word ? "" : " ") + word;
    }
    is_first_word = false;
  }
  return text + line + '\n';
}

std::string settings(const Json& set) {
  std::string text;
  for (const auto& [field, value] : set.items())
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", field, text_of(value));
  return text;
}

// A case has two lines at most; a long sweep has its table.
std::string answer(const Json& document) {
  constexpr std::size_t kMost = 12;
  const Json& sentences = document["answer"];
  std::string text = fmt::format("\nAnswer: {}\n", text_of(document["headline"]));
  for (std::size_t k = 0; k < std::min(kMost, sentences.size()); ++k)
    text += wrapped(text_of(sentences[k]), 2);
  if (sentences.size() > kMost) text += fmt::format("  and {} more cases, below\n", sentences.size() - kMost);
  return text + '\n';
}

std::string heading(const Json& document) {
  std::string text = fmt::format("Virtual experiment: {}\n", text_of(document["study"]));
  text += wrapped(text_of(document["description"])) + answer(document);
  text += "Scenario " + text_of(document["scenario"]) + "\n";
  if (!document["set"].empty()) text += wrapped("with " + settings(document["set"]));
  text += fmt::format("M = {} trials from trial {}, seed {}, generator {}\n", text_of(document["trials"]),
                      text_of(document["first_trial"]), text_of(document["seed"]),
                      text_of(document["generator"]));
  text += fmt::format("Coverage probability {}, {}\n", percent(document["coverage_probability"]),
                      text_of(document["method"]));
  text += fmt::format("trueblade {} (commit {}), hash of all rows {}\n", text_of(document["program_version"]),
                      text_of(document["program_commit"]), text_of(document["rows_hash"]));
  if (document.contains("stopping")) {
    const Json& s = document["stopping"];
    text += wrapped(
        fmt::format("{} is {} after {} blocks of {} trials: twice the largest standard error {}, numerical "
                    "tolerance {}",
                    text_of(s["quantity"]), s["stable"].get<bool>() ? "stable" : "not stable",
                    text_of(s["blocks"]), text_of(s["block_size"]),
                    short_number(s["largest_twice_standard_error"]), short_number(s["numerical_tolerance"])));
  }
  return text;
}

// A name fills the first column, or a line of its own where it is longer.
std::string first_column(const std::string& name) {
  constexpr std::size_t kColumn = 46;
  return name.size() <= kColumn ? fmt::format("{:{}}", name, kColumn)
                                : fmt::format("{}\n{:{}}", name, "", kColumn);
}

constexpr const char* kRow = "{} {:>7} {:>11} {:>11} {:>11} {:>11} {:>11} {:>11} {:>11}  {}\n";

std::string statement_head(const std::string& title) {
  return fmt::format("{} {:>7} {:>11} {:>11} {:>11} {:>23} {:>23}\n", first_column(""), "", "", "", "",
                     "symmetric interval", "shortest interval") +
         fmt::format(kRow, first_column(title), "values", "mean", "bias", "u", "low", "high", "low", "high",
                     "unit");
}

std::string statement_row(const std::string& name, const Json& q) {
  return fmt::format(kRow, first_column(name), text_of(q["values"]), short_number(q["mean"]),
                     short_number(q.value("bias", Json())), short_number(q["standard_uncertainty"]),
                     short_number(q["symmetric_interval"][0]), short_number(q["symmetric_interval"][1]),
                     short_number(q["shortest_interval"][0]), short_number(q["shortest_interval"][1]),
                     text_of(q["unit"]));
}

// Cases that the budget added are told by the budget.
std::vector<Json> given_cases(const Json& document) {
  std::vector<Json> given;
  for (const Json& item : document["cases"])
    if (!item.contains("for_budget")) given.push_back(item);
  return given;
}

// One quantity over the cases.
std::string overview(const Json& document, const std::vector<Json>& cases) {
  if (cases.size() < 2) return "";
  const std::string headline = text_of(document["headline"]);
  std::string text = "\nAll cases: " + headline + "\n" + statement_head("case");
  for (const Json& item : cases)
    if (item.contains("quantities") && item["quantities"].contains(headline) &&
        item["quantities"][headline].contains("mean"))
      text += statement_row(text_of(item["name"]), item["quantities"][headline]);
  return text;
}

std::string theory(const Json& item) {
  std::string text;
  if (!item.contains("theory")) return text;
  for (const auto& [view, t] : item["theory"].items()) {
    if (t.contains("components")) {
      text += fmt::format("\n{} {:>11} {:>18} {:>13} {:>15}\n", first_column("pose error of view " + view),
                          "u", "Cramer-Rao bound", "u / bound", "reported (RMS)");
      for (const Json& c : t["components"])
        text += fmt::format("{} {:>11} {:>18} {:>13} {:>15}\n", first_column(text_of(c["component"])),
                            short_number(c["spread"]), short_number(c["cramer_rao_bound"]),
                            short_number(c["spread_to_bound"]), short_number(c["reported"]));
    }
    if (!t.contains("coverage_of_reported_covariance")) continue;
    const Json& c = t["coverage_of_reported_covariance"];
    text += wrapped(
        fmt::format("The reported covariance of view {}, stated to cover {}, covers the true pose in {} of "
                    "{} trials (95 % "
                    "confidence: {} to {}).",
                    view, percent(c["stated"]), percent(c["observed"]), text_of(c["trials"]),
                    percent(c["confidence_interval_95"][0]), percent(c["confidence_interval_95"][1])));
  }
  return text;
}

std::string failures(const Json& item) {
  if (item["failures"].empty()) return "No trial failed.\n";
  std::string text;
  for (const Json& failure : item["failures"])
    text += wrapped(
        fmt::format("Failed: {} of {}, first trial {}: {}", text_of(failure["count"]),
                    text_of(item["trials"]), text_of(failure["first_trial"]), text_of(failure["reason"])),
        2);
  return text;
}

std::string without_value(const Json& item) {
  std::string text;
  if (!item.contains("quantities")) return text;
  for (const auto& [name, quantity] : item["quantities"].items())
    if (quantity.contains("without_value"))
      text += fmt::format("No value of {}: {} of {}, first trial {}\n", name,
                          text_of(quantity["without_value"]["count"]), text_of(item["trials"]),
                          text_of(quantity["without_value"]["first_trial"]));
  return text;
}

std::string case_text(const Json& item) {
  std::string title = fmt::format("Case \"{}\"", text_of(item["name"]));
  if (item.contains("views")) title += ", views " + text_of(item["views"]);
  if (item.contains("set")) title += ": " + settings(item["set"]);
  std::string rows;
  if (item.contains("quantities"))
    for (const auto& [name, q] : item["quantities"].items())
      if (q.contains("mean")) rows += statement_row(name, q);
  return "\n" + wrapped(title) +
         (rows.empty() ? "Too few values for a statement.\n" : statement_head("quantity") + rows) +
         theory(item) + failures(item) + without_value(item);
}

std::string comparison(const Json& c, const Json& probability) {
  if (!c.contains("quantities")) return "";
  std::string same;
  std::string text = "\n" + wrapped(fmt::format("The same trials, \"{}\" minus \"{}\"", text_of(c["second"]),
                                                text_of(c["first"])));
  text += fmt::format("{} {:>7} {:>15} {:>15} {:>11} {:>11}  unit  {} % confidence\n",
                      first_column("quantity"), "pairs", "mean difference", "standard error", "low", "high",
                      100.0 * probability.get<double>());
  for (const auto& [name, d] : c["quantities"].items()) {
    if (d["mean_difference"] == 0.0 && d["standard_error"] == 0.0) {
      same += (same.empty() ? "" : ", ") + name;
      continue;
    }
    text += fmt::format("{} {:>7} {:>15} {:>15} {:>11} {:>11}  {:4}  {}\n", first_column(name),
                        text_of(d["pairs"]), short_number(d["mean_difference"]),
                        short_number(d["standard_error"]), short_number(d["confidence_interval"][0]),
                        short_number(d["confidence_interval"][1]), text_of(d["unit"]),
                        d["significant"].get<bool>() ? "without zero" : "holds zero");
  }
  if (!same.empty()) text += wrapped("The same in every pair: " + same);
  return text;
}

std::string budget(const Json& document) {
  const std::string headline = text_of(document["headline"]);
  if (!document["budget"].contains(headline)) return "";
  const Json& b = document["budget"][headline];
  std::string text = "\n" + wrapped(fmt::format("Budget of {}: {}", headline, text_of(b["advice"])));
  constexpr const char* kSourceRow = "{:20} {:>14} {:>15} {:>14} {:>15} {:>14} {:>15}\n";
  text += fmt::format(kSourceRow, "source", "u alone", "standard error", "first order", "standard error",
                      "total", "standard error");
  for (const Json& row : b["sources"]) {
    const auto cell = [&](const char* key) { return short_number(row.value(key, Json())); };
    text += fmt::format(kSourceRow, text_of(row["source"]), cell("alone_standard_uncertainty"),
                        cell("alone_standard_uncertainty_error"), cell("first_order"),
                        cell("first_order_error"), cell("total"), cell("total_error"));
  }
  for (const Json& item : document["cases"])
    if (item.contains("for_budget") && !item["failures"].empty())
      text += fmt::format("Case \"{}\" of the budget\n", text_of(item["name"])) + failures(item);
  return text;
}

std::string influence(const std::string& title, const Json& item) {
  std::string words = text_of(item["distribution"]);
  for (const char* key : {"scope", "provenance"})
    if (item.contains(key)) words += "; " + text_of(item[key]);
  return wrapped(title, 2) + wrapped(words, 6);
}

std::string influences(const Json& influences, const Json& first_case) {
  std::string text =
      fmt::format("\nInfluences that are covered in case \"{}\": distribution; scope; provenance\n",
                  text_of(first_case["name"]));
  for (const Json& item : influences["covered"]) text += influence(text_of(item["influence"]), item);
  std::string names;
  for (const Json& item : influences["not_covered"]) names += (names.empty() ? "" : "; ") + text_of(item);
  text += "\nInfluences that are not covered (ISO/TS 15530-4 asks for them to be named)\n" +
          wrapped(names + ".", 2);
  if (influences["differences"].empty()) return text + "The influences are the same in all cases.\n";
  text += "\nWhat the other cases have otherwise\n";
  for (const Json& item : influences["differences"])
    text +=
        influence(fmt::format("case \"{}\", {}", text_of(item["case"]), text_of(item["influence"])), item);
  return text;
}

std::string terms(const Json& document) {
  std::string text = "\nTerms\n";
  for (const auto& [term, meaning] : document["terms"].items())
    text += wrapped(term + ": " + text_of(meaning), 2);
  return text;
}

constexpr const char* kLimit =
    "\nWhat the stated influences do is stated, and nothing about others. Terms are explained at the end.\n";

}  // namespace

std::string study_text(const Json& document) {
  const std::vector<Json> cases = given_cases(document);
  std::string text = heading(document) + kLimit + overview(document, cases);
  for (const Json& item : cases) text += case_text(item);
  for (const Json& item : document["comparisons"]) text += comparison(item, document["coverage_probability"]);
  return text + budget(document) + influences(document["influences"], cases.front()) + terms(document);
}

}  // namespace trueblade
