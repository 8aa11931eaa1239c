#include "apps/study/study_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/wrong_file.h"
#include "apps/yaml_reader.h"

namespace trueblade {
namespace {

constexpr std::pair<std::string_view, ViewPolicy> kViewPolicies[] = {{"separate", ViewPolicy::separate},
                                                                     {"together", ViewPolicy::together}};
constexpr std::pair<std::string_view, BudgetMethod> kBudgetMethods[] = {
    {"one_at_a_time", BudgetMethod::one_at_a_time}, {"sobol", BudgetMethod::sobol}};

void fields(YamlFields& io, FieldValue& set) {
  io.require("field");
  io.require("value");
  io.text("field", set.field);
  io.text("value", set.value);
}

void fields(YamlFields& io, CaseSpec& item) {
  io.require("name");
  io.text("name", item.name);
  io.list<FieldValue>("set", item.set, [](YamlFields& inner, FieldValue& set) { fields(inner, set); });
  io.choice<ViewPolicy>("views", item.views, kViewPolicies);
}

void fields(YamlFields& io, SweepSpec& sweep) {
  io.require("field");
  io.require("values");
  io.text("field", sweep.field);
  io.texts("values", sweep.values);
  io.check([&] {
    if (io.present("values") && sweep.values.empty())
      throw InputError("values is empty, must hold at least one");
  });
}

void fields(YamlFields& io, ToleranceSpec& tolerance) {
  io.require("quantity");
  io.text("quantity", tolerance.quantity);
  io.integer("significant_digits", tolerance.significant_digits, 1, 4);
  io.number("absolute", tolerance.absolute, above(0.0));
  io.integer("maximum_trials", tolerance.maximum_trials, 1, std::uint64_t{1} << 40);
}

void surfaces_field(YamlFields& io, SurfaceTexts& surfaces) {
  io.texts("surfaces", surfaces.texts);
  surfaces.place = io.place("surfaces");
}

void fields(YamlFields& io, ProfileQuantity& profile) {
  io.require("name");
  io.text("name", profile.name);
  surfaces_field(io, profile.surfaces);
}

void budget_field(YamlFields& io, std::vector<BudgetMethod>& budget) {
  std::vector<std::string> names;
  io.texts("budget", names);
  io.check([&] {
    for (const std::string& name : names) {
      const auto known = std::find_if(std::begin(kBudgetMethods), std::end(kBudgetMethods),
                                      [&](const auto& method) { return method.first == name; });
      if (known == std::end(kBudgetMethods))
        throw InputError(fmt::format("budget holds \"{}\", must be one_at_a_time or sobol", name));
      budget.push_back(known->second);
    }
  });
}

void check_study(const StudySpec& study) {
  std::set<std::string> names;
  for (const CaseSpec& item : study.cases)
    if (!names.insert(item.name).second)
      throw InputError(fmt::format("cases holds \"{}\" twice, names must differ", item.name));
  if (study.tolerance && study.block > 0 && study.tolerance->maximum_trials < 2 * study.block)
    throw InputError(fmt::format("tolerance.maximum_trials is {}, must be at least two blocks of {}",
                                 study.tolerance->maximum_trials, study.block));
}

void fields(YamlFields& io, StudySpec& study) {
  for (const char* key : {"part", "scan"})
    if (io.holds_foreign(key) && !io.present("scenario"))
      throw io.error(
          key,
          "this is a scenario, must be a study; `trueblade inspect` inspects a scenario, and a study "
          "names one as scenario: FILE");
  io.text("name", study.name);
  io.text("description", study.description);
  io.require("scenario");
  std::string scenario;
  io.text("scenario", scenario);
  study.scenario = study.file.parent_path() / scenario;
  io.integer("seed", study.seed, 0, std::numeric_limits<std::uint64_t>::max());
  io.integer("trials", study.trials, 1, std::uint64_t{1} << 40);
  io.optional_map<ToleranceSpec>("tolerance", study.tolerance,
                                 [](YamlFields& inner, ToleranceSpec& item) { fields(inner, item); });
  io.integer("block", study.block, 100, std::uint64_t{1} << 30);
  io.number("coverage_probability", study.coverage_probability, between(0.5, 0.9999));
  io.list<FieldValue>("set", study.set, [](YamlFields& inner, FieldValue& item) { fields(inner, item); });
  io.list<CaseSpec>("cases", study.cases, [](YamlFields& inner, CaseSpec& item) { fields(inner, item); });
  io.list<SweepSpec>("sweep", study.sweep, [](YamlFields& inner, SweepSpec& item) { fields(inner, item); });
  budget_field(io, study.budget);
  io.text("headline", study.headline);
  io.texts("quantities", study.quantities);
  surfaces_field(io, study.surfaces);
  io.list<ProfileQuantity>("profiles", study.profiles,
                           [](YamlFields& inner, ProfileQuantity& item) { fields(inner, item); });
  if (study.headline.empty() && !study.quantities.empty()) study.headline = study.quantities.front();
  if (io.present("trials") && study.tolerance)
    throw io.error(
        "tolerance",
        "trials and tolerance are both given, must be one of them: so many trials, or as many as the "
        "tolerance needs");
  io.check([&] { check_study(study); });
}

// All combinations of the sweeps' values, the last one running fastest.
std::vector<std::vector<std::string>> combinations(const std::vector<SweepSpec>& sweeps) {
  std::vector<std::vector<std::string>> all{{}};
  for (const SweepSpec& sweep : sweeps) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& head : all)
      for (const std::string& value : sweep.values) {
        longer.push_back(head);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  return all;
}

std::string last_key(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? path : path.substr(dot + 1);
}

Scenario scenario_with(const StudySpec& study, const std::string& name, const std::vector<FieldValue>& set) {
  std::vector<YamlOverride> overrides;
  for (const FieldValue& item : set) overrides.push_back({item.field, item.value});
  try {
    Scenario scenario = read_scenario(study.scenario, overrides);
    drop_expectations(scenario);
    scenario.seed = study.seed;
    if (scenario.machine.backend != "simulated")
      throw InputError("machine.backend must be simulated: a study needs to know the truth");
    return scenario;
  } catch (const InputError& failure) {
    if (set.empty()) throw;
    throw file_error(study.file.string(), fmt::format("case \"{}\": {}", name, failure.what()));
  }
}

bool has_random_form(const Scenario& scenario) {
  const FormErrors& errors = scenario.machine.simulation.form_errors;
  return std::any_of(errors.begin(), errors.end(),
                     [](const FormError& error) { return std::holds_alternative<RandomForm>(error); });
}

// The scenario with every source silent but one. Means stay: they are part of the set-up.
void silence_all_but(const std::string& source, Scenario& scenario) {
  SimulationSpec& simulation = scenario.machine.simulation;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto number = static_cast<ErrorSource>(s);
    if (info(number).name != source) simulation.errors[number].sigma = 0.0;
  }
  if (source != "sensor") {
    simulation.sensor.noise_scale = 0.0;
    simulation.sensor.speckle = 0.0;
    simulation.sensor.multiple_reflection = 0.0;
  }
  if (source != "form")
    std::erase_if(simulation.form_errors,
                  [](const FormError& error) { return std::holds_alternative<RandomForm>(error); });
}

void draw_anew(const std::string& source, Scenario& scenario) {
  SimulationSpec& simulation = scenario.machine.simulation;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto number = static_cast<ErrorSource>(s);
    if (info(number).name == source) simulation.errors[number].replicate = 1;
  }
  if (source == "sensor") simulation.sensor_replicate = 1;
  if (source == "form") simulation.form_replicate = 1;
}

bool asks_for(const StudySpec& study, BudgetMethod method) {
  return std::find(study.budget.begin(), study.budget.end(), method) != study.budget.end();
}

void add_budget_cases(const StudySpec& study, std::vector<StudyCase>& cases) {
  const StudyCase base = cases.front();
  const std::vector<std::string> sources = active_sources(base.scenario);
  const auto add = [&](StudyCase::Role role, const std::string& source, const std::string& name) {
    StudyCase item = base;
    item.role = role;
    item.source = source;
    item.name = name;
    item.sweep_values.clear();
    cases.push_back(item);
    return &cases.back().scenario;
  };
  if (asks_for(study, BudgetMethod::one_at_a_time))
    for (const std::string& source : sources)
      silence_all_but(source, *add(StudyCase::Role::only_source, source, "only " + source));
  if (asks_for(study, BudgetMethod::sobol)) {
    Scenario& all_anew = *add(StudyCase::Role::all_anew, "", "all anew");
    for (const std::string& source : sources) draw_anew(source, all_anew);
    for (const std::string& source : sources)
      draw_anew(source, *add(StudyCase::Role::source_anew, source, source + " anew"));
  }
}

}  // namespace

StudySpec read_study(const std::filesystem::path& file) {
  refuse_part_or_scan(file, "a study");
  StudySpec study;
  study.file = file;
  study.name = file.stem().string();
  read_yaml(file, [&](YamlFields& io) { fields(io, study); });
  return study;
}

std::vector<std::string> active_sources(const Scenario& scenario) {
  std::vector<std::string> names;
  const SimulationSpec& simulation = scenario.machine.simulation;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    if (simulation.errors[source].sigma > 0.0) names.emplace_back(info(source).name);
  }
  if (simulation.sensor.noise_scale > 0.0 || simulation.sensor.speckle > 0.0) names.emplace_back("sensor");
  if (has_random_form(scenario)) names.emplace_back("form");
  return names;
}

std::vector<StudyCase> cases_of(const StudySpec& study) {
  scenario_with(study, "", {});  // defects of the scenario itself are told as such
  std::vector<CaseSpec> given = study.cases;
  if (given.empty()) given.push_back({"scenario", {}, ViewPolicy::separate});
  std::vector<StudyCase> cases;
  for (const CaseSpec& item : given) {
    for (const auto& values : combinations(study.sweep)) {
      std::vector<FieldValue> own = item.set;
      std::vector<std::string> labels;
      for (std::size_t k = 0; k < values.size(); ++k) {
        own.push_back({study.sweep[k].field, values[k]});
        labels.push_back(last_key(study.sweep[k].field) + " " + values[k]);
      }
      std::string name = fmt::format("{}", fmt::join(labels, ", "));
      if (name.empty())
        name = item.name;
      else if (given.size() > 1)
        name = item.name + ", " + name;
      std::vector<FieldValue> set = study.set;
      set.insert(set.end(), own.begin(), own.end());
      cases.push_back(
          {name, scenario_with(study, name, set), item.views, own, values, StudyCase::Role::given, ""});
    }
  }
  if (!study.budget.empty()) add_budget_cases(study, cases);
  return cases;
}

}  // namespace trueblade
