#include "apps/study/study_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "apps/measure.h"
#include "apps/nearest_word.h"
#include "apps/study/part_quantities.h"
#include "apps/study/view_quantities.h"
#include "apps/yaml_writer.h"
#include "hardware/execute_plan.h"
#include "inspection/datum_fit.h"
#include "inspection/surface_selection.h"

namespace trueblade {
namespace {

constexpr const char* kTogether = "together";
constexpr const char* kPart = "part";  // stands for a view in the names of what is said of the part

// A part with its search structures, shared by the cases and threads.
struct SharedPart {
  explicit SharedPart(const PartSpec& spec)
      : nominal(put_on_machine(make_part(spec))), target(*nominal.part) {}
  PartOnMachine nominal;
  RegistrationTarget target;
};

// A part as it stands on the machine, where it is the same in every trial.
struct CaseSetup {
  std::shared_ptr<SharedPart> part;
  std::shared_ptr<const std::vector<ScanPlan>> plans;  // one per view
  std::optional<VirtualPart> virtual_part;             // nullopt: its form is drawn in every trial
  std::string scan_key;  // cases with the same key measure the same: one scan serves them

  std::vector<std::uint32_t> datum_surfaces;
  std::shared_ptr<const PartMeasurands> measurands;  // null: nothing is kept of the part as a whole
};

// One trial's scans of all views.
struct TrialScan {
  VirtualPart part;
  std::vector<ViewScan> views;
  std::vector<SimulationTruth> truths;
};

// The last scan of a trial, and what it was made of.
struct SharedScan {
  std::optional<TrialScan> scan;
  std::string key;
};

bool form_is_random(const Scenario& scenario) {
  const auto sources = active_sources(scenario);
  return std::find(sources.begin(), sources.end(), "form") != sources.end();
}

TrialScan scan_trial(const StudyCase& study_case, const CaseSetup& setup, std::uint64_t trial) {
  Scenario scenario = study_case.scenario;
  scenario.trial = trial;
  const VirtualPart part =
      setup.virtual_part ? *setup.virtual_part : virtual_part(scenario, setup.part->nominal);
  SimulatedMachine machine(part, virtual_setup(scenario));
  TrialScan scan{part, {}, {}};
  for (const ScanPlan& plan : *setup.plans) {
    scan.views.push_back(execute_plan(machine, scenario.machine.geometry, plan));
    scan.truths.push_back(machine.take_truth());
  }
  return scan;
}

void append_usable(const ViewScan& view, const SimulationTruth& truth, RegisteredPoints& registered,
                   ScanPoints& points) {
  for (std::size_t k = 0; k < view.usable.size(); ++k) {
    registered.points.push_back(
        {view.points.position_mcs_mm[k], view.points.snr[k], truth.hits[view.usable[k]].value()});
    points.position_mcs_mm.push_back(view.points.position_mcs_mm[k]);
    points.snr.push_back(view.points.snr[k]);
  }
  registered.true_part_from_mcs = truth.part_from_mcs;
}

std::string text_of(const PartSpec& spec) {
  PartSpec copy = spec;
  return yaml_text([&](YamlFields& io) { fields(io, copy, {}); });
}

// Everything that the scan of a case depends on.
std::string scan_key_of(const Scenario& scenario) {
  Scenario copy = scenario;
  copy.name = "-";
  copy.description.clear();
  copy.registration = {};
  copy.inspection = {};
  return scenario_text(copy);
}

std::vector<std::string> view_names(const StudyCase& item, const std::vector<ScanPlan>& plans) {
  if (item.views == ViewPolicy::together) return {kTogether};
  std::vector<std::string> names;
  for (const ScanPlan& plan : plans) names.push_back(plan.view);
  return names;
}

}  // namespace

struct StudyModel::Impl {
  StudySpec study;
  SelectedSurfaces selected;
  std::vector<CaseSetup> setups;           // one per case
  std::vector<Quantity> of_view;           // without the view
  std::vector<std::string> views;          // of all cases
  std::vector<std::vector<bool>> is_kept;  // per view and quantity
  std::vector<Quantity> of_part;           // of all cases, without "part."
  std::vector<std::string> kept_of_part;   // the same, those that are kept
  std::vector<Quantity> kept;              // of the views in order, then of the part

  // Quantities are called after their surfaces, so that these must be the same in all cases.
  void select_surfaces_of(const std::vector<StudyCase>& cases) {
    for (std::size_t number = 0; number < cases.size(); ++number) {
      const SelectedSurfaces of_case = selected_surfaces(study, setups[number].part->target.part());
      if (number == 0) selected = of_case;
      if (of_case != selected)
        throw file_error(study.file.string(),
                         fmt::format("surfaces and profiles name other surfaces in case \"{}\" than in case "
                                     "\"{}\", must name the same in all",
                                     cases[number].name, cases.front().name));
    }
  }

  void choose_quantities() {
    std::vector<std::string> all;
    for (const std::string& view : views)
      for (const Quantity& quantity : of_view) all.push_back(view + "." + quantity.name);
    for (const Quantity& quantity : of_view) all.push_back(quantity.name);
    for (const Quantity& quantity : of_part) {
      all.push_back(std::string(kPart) + "." + quantity.name);
      all.push_back(quantity.name);
    }
    for (const std::string& name : study.quantities) require_known(name, "quantities", all);
    if (!study.headline.empty()) require_known(study.headline, "headline", all);
    if (study.tolerance) require_known(study.tolerance->quantity, "tolerance.quantity", all);
    for (const std::string& view : views) {
      is_kept.emplace_back();
      for (const Quantity& quantity : of_view) {
        const std::string full = view + "." + quantity.name;
        is_kept.back().push_back(is_always_kept(quantity.name) || is_wanted(full, quantity.name));
        if (is_kept.back().back()) kept.push_back({full, quantity.unit, quantity.description});
      }
    }
    for (const Quantity& quantity : of_part) {
      const std::string full = std::string(kPart) + "." + quantity.name;
      if (!quantity.name.starts_with("profile_") && !is_wanted(full, quantity.name)) continue;
      kept_of_part.push_back(quantity.name);
      kept.push_back({full, quantity.unit, quantity.description});
    }
  }

  void prepare_measurands(const StudyCase& item, CaseSetup& setup) const {
    setup.datum_surfaces =
        select_surfaces(setup.part->target.part(), item.scenario.inspection.datum_surfaces);
    std::vector<std::string> wanted;
    for (const Quantity& quantity : part_quantities(study, item.scenario))
      if (std::find(kept_of_part.begin(), kept_of_part.end(), quantity.name) != kept_of_part.end())
        wanted.push_back(quantity.name);
    if (wanted.empty()) return;
    if (std::find(views.begin(), views.end(), kPart) != views.end())
      throw InputError(fmt::format("a view is named \"{}\", which stands for the part as a whole", kPart));
    setup.measurands = std::make_shared<PartMeasurands>(setup.part->target, study, item.scenario,
                                                        selected.profiles, wanted, setup.virtual_part);
  }

  bool is_wanted(const std::string& full, const std::string& name) const {
    const auto asks = [&](const std::string& word) { return word == full || word == name; };
    if (study.quantities.empty() || asks(study.headline)) return true;
    if (study.tolerance && asks(study.tolerance->quantity)) return true;
    return std::any_of(study.quantities.begin(), study.quantities.end(), asks);
  }

  void require_known(const std::string& name, const std::string& key,
                     const std::vector<std::string>& all) const {
    if (std::find(all.begin(), all.end(), name) != all.end()) return;
    const auto nearest = nearest_word(name, all);
    throw file_error(study.file.string(),
                     fmt::format("{}: there is no quantity \"{}\"{}", key, name,
                                 nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : ""));
  }

  // Why the result of a registration is none; empty: it is one.
  static std::string doubt(const std::string& view, const RegistrationResult& result) {
    if (!is_converged(result.termination))
      return fmt::format("{}: the registration did not converge: {}", view, to_string(result.termination));
    // Their error is that of the set-up, and no uncertainty says so.
    if (!result.undetermined.empty())
      return fmt::format("{}: the points leave {} of 6 degrees of freedom undetermined", view,
                         result.undetermined.size());
    return "";
  }

  // Puts the values of the view at their places; returns why there is no result.
  std::string evaluate_view(const StudyCase& item, const CaseSetup& setup, const std::string& view,
                            const RegisteredPoints& registered, const ScanPoints& points,
                            const RegistrationResult& result, const VirtualPart& part,
                            std::vector<double>& values) const {
    const auto view_number =
        static_cast<std::size_t>(std::find(views.begin(), views.end(), view) - views.begin());
    const std::vector<bool>& wanted = is_kept[view_number];
    const std::vector<double> of_this = values_of_view(selected, item.scenario, setup.part->target,
                                                       *part.model, registered, points, result, wanted);
    std::size_t place = 0;
    for (std::size_t v = 0; v < view_number; ++v)
      place += static_cast<std::size_t>(std::count(is_kept[v].begin(), is_kept[v].end(), true));
    for (std::size_t k = 0; k < of_this.size(); ++k)
      if (wanted[k]) values[place++] = of_this[k];
    return doubt(view, result);
  }

  // The same of the part as a whole.
  std::string evaluate_part(const CaseSetup& setup, const RegisteredPoints& registered,
                            const ScanPoints& points, const RegistrationResult& result,
                            const VirtualPart& part, std::vector<double>& values) const {
    const std::string doubtful = doubt(kPart, result);
    if (!doubtful.empty()) return doubtful;
    const auto measured = setup.measurands->evaluate(points, result, registered, part);
    const std::size_t first = kept.size() - kept_of_part.size();
    for (std::size_t k = 0; k < kept_of_part.size(); ++k)
      if (const auto found = measured.find(kept_of_part[k]); found != measured.end())
        values[first + k] = found->second;
    return "";
  }

  Outcome evaluate_case(const StudyCase& item, std::uint32_t number, const TrialScan& scan,
                        std::uint64_t trial) const {
    const CaseSetup& setup = setups[number];
    Outcome outcome{number, trial, "", std::vector<double>(kept.size(), kNoValue)};
    const auto note = [&](const std::string& failure) {
      if (outcome.failure.empty()) outcome.failure = failure;
    };
    // As in an inspection: a view of several is registered by its own best fit; all points together, and
    // the points of an only view, on the datum surfaces where there are any.
    const bool apart = item.views == ViewPolicy::separate && scan.views.size() > 1;
    const auto register_points = [&](const ScanPoints& points, const std::vector<std::uint32_t>& datum) {
      return register_to_datum(setup.part->target, points, item.scenario.machine.mcs_from_part.inverse(),
                               item.scenario.registration.options, datum);
    };
    // Without the counts of an inspection's message, which would make a reason of its own of every trial.
    const auto require_points = [](const ViewScan& view) {
      const std::string nothing = nothing_measured(view);
      if (!nothing.empty()) throw InputError(nothing);
    };
    try {
      RegisteredPoints registered;
      ScanPoints points;
      for (std::size_t v = 0; v < scan.views.size(); ++v) {
        if (apart) {
          require_points(scan.views[v]);
          RegisteredPoints registered_of_view;
          ScanPoints points_of_view;
          append_usable(scan.views[v], scan.truths[v], registered_of_view, points_of_view);
          note(evaluate_view(item, setup, scan.views[v].view, registered_of_view, points_of_view,
                             register_points(points_of_view, {}), scan.part, outcome.values));
        }
        if (!apart || setup.measurands) append_usable(scan.views[v], scan.truths[v], registered, points);
      }
      if (!apart || setup.measurands) {
        if (points.size() == 0) require_points(scan.views.front());
        const RegistrationResult result = register_points(points, setup.datum_surfaces);
        if (!apart)
          note(evaluate_view(item, setup,
                             item.views == ViewPolicy::together ? kTogether : scan.views.front().view,
                             registered, points, result, scan.part, outcome.values));
        if (setup.measurands)
          note(evaluate_part(setup, registered, points, result, scan.part, outcome.values));
      }
    } catch (const InputError& failure) {
      note(failure.what());
    }
    return outcome;
  }

  // Scans, unless the case before measured the same, and evaluates.
  Outcome run_case(const StudyCase& item, std::uint32_t number, std::uint64_t trial,
                   SharedScan& shared) const {
    const CaseSetup& setup = setups[number];
    try {
      if (!shared.scan || shared.key != setup.scan_key)
        shared = {scan_trial(item, setup, trial), setup.scan_key};
      return evaluate_case(item, number, *shared.scan, trial);
    } catch (const MachineFault& fault) {
      shared.scan.reset();
      return {number, trial, fault.what(), std::vector<double>(kept.size(), kNoValue)};
    }
  }
};

StudyModel::StudyModel(const StudySpec& study, std::vector<StudyCase> cases)
    : cases_(std::move(cases)), impl_(std::make_unique<Impl>()) {
  impl_->study = study;
  std::map<std::string, std::shared_ptr<SharedPart>> parts;
  std::map<std::string, CaseSetup> scans;
  for (const StudyCase& item : cases_) {
    const std::string scan_key = scan_key_of(item.scenario);
    auto known = scans.find(scan_key);
    if (known == scans.end()) {
      CaseSetup setup;
      std::shared_ptr<SharedPart>& part = parts[text_of(item.scenario.part)];
      if (!part) part = std::make_shared<SharedPart>(item.scenario.part);
      setup.part = part;
      setup.scan_key = scan_key;
      setup.plans = std::make_shared<const std::vector<ScanPlan>>(
          plan_views(item.scenario, part->nominal, views_of(item.scenario, part->nominal)));
      if (!form_is_random(item.scenario)) setup.virtual_part = virtual_part(item.scenario, part->nominal);
      known = scans.emplace(scan_key, std::move(setup)).first;
    }
    impl_->setups.push_back(known->second);
    for (const std::string& view : view_names(item, *known->second.plans))
      if (std::find(impl_->views.begin(), impl_->views.end(), view) == impl_->views.end())
        impl_->views.push_back(view);
  }
  impl_->select_surfaces_of(cases_);
  impl_->of_view = view_quantities(impl_->selected);
  for (const StudyCase& item : cases_)
    for (const Quantity& quantity : part_quantities(study, item.scenario))
      if (std::none_of(impl_->of_part.begin(), impl_->of_part.end(),
                       [&](const Quantity& known) { return known.name == quantity.name; }))
        impl_->of_part.push_back(quantity);
  impl_->choose_quantities();
  for (std::size_t number = 0; number < cases_.size(); ++number)
    impl_->prepare_measurands(cases_[number], impl_->setups[number]);
}

StudyModel::~StudyModel() = default;

const std::vector<Quantity>& StudyModel::quantities() const {
  return impl_->kept;
}

std::vector<Outcome> StudyModel::evaluate(std::uint64_t trial) const {
  std::vector<Outcome> outcomes;
  SharedScan scan;
  for (std::uint32_t number = 0; number < cases_.size(); ++number)
    outcomes.push_back(impl_->run_case(cases_[number], number, trial, scan));
  return outcomes;
}

Outcome StudyModel::evaluate_case(std::uint32_t number, std::uint64_t trial) const {
  SharedScan scan;
  return impl_->run_case(cases_[number], number, trial, scan);
}

}  // namespace trueblade
