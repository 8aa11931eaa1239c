#include "apps/expectation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "inspection/section_definitions.h"

namespace trueblade {
namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

struct Quantity {
  std::string_view name;
  double (*of)(const ViewResult&);
};

double count(std::size_t number) {
  return static_cast<double>(number);
}

// The names are those of result.json.
constexpr std::array<Quantity, 19> kQuantities{{
    {"planned", [](const ViewResult& view) { return count(view.planned); }},
    {"points", [](const ViewResult& view) { return count(view.statistics.points); }},
    {"out_of_range", [](const ViewResult& view) { return count(view.out_of_range); }},
    {"missed", [](const ViewResult& view) { return count(view.missed); }},
    {"converged",
     [](const ViewResult& view) { return is_converged(view.registration.termination) ? 1.0 : 0.0; }},
    {"iterations", [](const ViewResult& view) { return static_cast<double>(view.registration.iterations); }},
    {"inliers", [](const ViewResult& view) { return count(view.registration.inliers); }},
    {"outliers", [](const ViewResult& view) { return count(view.registration.outliers); }},
    {"shows_misfit", [](const ViewResult& view) { return view.registration.shows_misfit ? 1.0 : 0.0; }},
    {"inlier_percent",
     [](const ViewResult& view) {
       return 100.0 * count(view.registration.inliers) / count(view.statistics.points);
     }},
    {"undetermined", [](const ViewResult& view) { return count(view.registration.undetermined.size()); }},
    {"initial_rms_mm", [](const ViewResult& view) { return view.initial_rms_mm; }},
    {"weighted_rms_mm", [](const ViewResult& view) { return view.registration.weighted_rms_mm; }},
    {"rms_mm", [](const ViewResult& view) { return view.statistics.rms_mm; }},
    {"mean_mm", [](const ViewResult& view) { return view.statistics.mean_mm; }},
    {"min_mm", [](const ViewResult& view) { return view.statistics.min_mm; }},
    {"max_mm", [](const ViewResult& view) { return view.statistics.max_mm; }},
    {"translation_error_mm",
     [](const ViewResult& view) { return view.truth ? view.truth->translation_error_mm : kAbsent; }},
    {"rotation_error_rad",
     [](const ViewResult& view) { return view.truth ? view.truth->rotation_error_rad : kAbsent; }},
}};

double value_of(const std::string& quantity, const ViewResult& view) {
  const auto row = std::find_if(kQuantities.begin(), kQuantities.end(),
                                [&](const Quantity& candidate) { return candidate.name == quantity; });
  return row == kQuantities.end() ? kAbsent : row->of(view);
}

Verdict in_range(const std::string& view, const std::string& quantity, const std::pair<double, double>& range,
                 double got) {
  Verdict verdict;
  verdict.view = view;
  verdict.quantity = quantity;
  verdict.low = range.first;
  verdict.high = range.second;
  verdict.got = got;
  verdict.holds = got >= range.first && got <= range.second;  // NaN does not
  return verdict;
}

Verdict in_words(const std::string& view, const std::string& quantity, const std::string& expected,
                 const std::string& got, bool holds) {
  Verdict verdict;
  verdict.view = view;
  verdict.quantity = quantity;
  verdict.expected_text = expected;
  verdict.got_text = got;
  verdict.holds = holds;
  return verdict;
}

constexpr const char* kComponents[] = {"rotation_x_rad",   "rotation_y_rad",   "rotation_z_rad",
                                       "translation_x_mm", "translation_y_mm", "translation_z_mm"};

std::map<std::string, double> numbers_of(const EvaluationResult& evaluation) {
  std::map<std::string, double> numbers;
  numbers["missing"] = count(evaluation.missing.size());
  numbers["missing_features"] = count(evaluation.missing_features.size());
  if (evaluation.joint) numbers["joint.rms_mm"] = evaluation.joint->statistics.rms_mm;
  for (const ProfileResult& profile : evaluation.profiles) {
    const std::string name = "profile." + profile.callout.name;
    numbers[name + ".profile_mm"] = profile.profile_mm;
    if (profile.conformity != Conformity::cannot_tell)
      numbers[name + ".conforming"] = profile.conformity == Conformity::conforming ? 1.0 : 0.0;
  }
  for (const SectionResult& section : evaluation.sections)
    for (const SectionFeature& feature : section.features)
      numbers[fmt::format("section.{:g}.{}", section.height_mm, feature.name)] = feature.deviation();
  for (const PoseDifference& offset : evaluation.offsets)
    for (std::size_t k = 0; k < 6; ++k)
      if (offset.determined[k])
        numbers[fmt::format("offset.{}.{}", offset.of, kComponents[k])] =
            offset.step[static_cast<Eigen::Index>(k)];
  return numbers;
}

}  // namespace

void fields(YamlFields& io, ViewExpectation& expectation) {
  for (const Quantity& quantity : kQuantities) {
    const std::string name(quantity.name);
    std::optional<std::pair<double, double>> range;
    if (const auto known = expectation.range_of.find(name); known != expectation.range_of.end())
      range = known->second;
    io.interval(name, range);
    if (range) expectation.range_of[name] = *range;
  }
  if (io.reading() || !expectation.termination.empty()) io.text("termination", expectation.termination);
  if (io.reading() || !expectation.fails.empty()) io.text("fails", expectation.fails);
}

std::string expected_words(const Verdict& verdict) {
  if (!verdict.expected_text.empty()) return verdict.expected_text;
  return fmt::format("{:.5g} to {:.5g}", verdict.low, verdict.high);
}

std::string got_words(const Verdict& verdict) {
  if (!verdict.expected_text.empty()) return verdict.got_text;
  return fmt::format("{:.5g}", verdict.got);
}

void fields(YamlFields& io, PartExpectation& expectation) {
  io.interval("value", expectation.value);
}

std::vector<Verdict> judge(const std::map<std::string, ViewExpectation>& expected,
                           const std::vector<ViewResult>& views) {
  std::vector<Verdict> verdicts;
  for (const auto& [name, expectation] : expected) {
    const auto view = std::find_if(views.begin(), views.end(),
                                   [&name = name](const ViewResult& result) { return result.view == name; });
    const bool exists = view != views.end();
    for (const auto& [quantity, range] : expectation.range_of)
      verdicts.push_back(in_range(name, quantity, range, exists ? value_of(quantity, *view) : kAbsent));
    const std::string failure = exists ? view->failure : "the view is not in the result";
    if (!expectation.fails.empty()) {
      verdicts.push_back(in_words(name, "fails", expectation.fails,
                                  failure.empty() ? "did not fail" : failure,
                                  failure.find(expectation.fails) != std::string::npos));
    } else if (!failure.empty()) {
      verdicts.push_back(in_words(name, "fails", "does not fail", failure, false));
    } else if (!expectation.termination.empty()) {
      const std::string termination = to_string(view->registration.termination);
      verdicts.push_back(in_words(name, "termination", expectation.termination, termination,
                                  termination == expectation.termination));
    }
  }
  return verdicts;
}

std::vector<std::string> part_quantities(const InspectionSpec& inspection) {
  std::vector<std::string> names{"missing", "missing_features", "joint.rms_mm"};
  for (const ProfileSpec& profile : inspection.profiles)
    for (const char* quantity : {"profile_mm", "conforming"})
      names.push_back(fmt::format("profile.{}.{}", profile.name, quantity));
  if (inspection.sections)
    for (const double height_mm : inspection.sections->heights_mm)
      for (const SectionFeatureName& feature : kSectionFeatures)
        names.push_back(fmt::format("section.{:g}.{}", height_mm, feature.name));
  for (std::size_t k = 1; k < inspection.groups.size(); ++k)  // each from the first
    for (const char* component : kComponents)
      names.push_back(fmt::format("offset.{}.{}", inspection.groups[k].name, component));
  return names;
}

std::vector<Verdict> judge_part(const std::map<std::string, PartExpectation>& expected,
                                const EvaluationResult& evaluation) {
  const std::map<std::string, double> numbers = numbers_of(evaluation);
  std::vector<Verdict> verdicts;
  for (const auto& [name, expectation] : expected) {
    if (!expectation.value) continue;
    const auto number = numbers.find(name);
    verdicts.push_back(
        in_range("part", name, *expectation.value, number == numbers.end() ? kAbsent : number->second));
  }
  return verdicts;
}

}  // namespace trueblade
