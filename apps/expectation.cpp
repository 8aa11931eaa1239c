#include "apps/expectation.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

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
constexpr std::array<Quantity, 16> kQuantities{{
    {"planned", [](const ViewResult& view) { return count(view.planned); }},
    {"points", [](const ViewResult& view) { return count(view.statistics.points); }},
    {"out_of_range", [](const ViewResult& view) { return count(view.out_of_range); }},
    {"missed", [](const ViewResult& view) { return count(view.missed); }},
    {"converged",
     [](const ViewResult& view) { return is_converged(view.registration.termination) ? 1.0 : 0.0; }},
    {"iterations", [](const ViewResult& view) { return static_cast<double>(view.registration.iterations); }},
    {"inliers", [](const ViewResult& view) { return count(view.registration.inliers); }},
    {"outliers", [](const ViewResult& view) { return count(view.registration.outliers); }},
    {"initial_rms_mm", [](const ViewResult& view) { return view.registration.initial_rms_mm; }},
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
}

std::vector<Verdict> judge(const std::map<std::string, ViewExpectation>& expected,
                           const std::vector<ViewResult>& views) {
  std::vector<Verdict> verdicts;
  for (const auto& [name, expectation] : expected) {
    const auto view = std::find_if(views.begin(), views.end(),
                                   [&name = name](const ViewResult& result) { return result.view == name; });
    for (const auto& [quantity, range] : expectation.range_of) {
      const double got = view == views.end() ? kAbsent : value_of(quantity, *view);
      const bool holds = got >= range.first && got <= range.second;  // NaN does not
      verdicts.push_back({name, quantity, range.first, range.second, got, holds});
    }
  }
  return verdicts;
}

}  // namespace trueblade
