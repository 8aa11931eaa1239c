// A study: one scenario, its errors drawn anew in every trial, as one YAML file (docs/studies.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/scenario.h"

namespace trueblade {

// A field of the scenario by its dotted path ("scan.spacing_mm", "scan.views.0.theta_deg") and its value as
// YAML text.
struct FieldValue {
  std::string field;
  std::string value;
};

struct SweepSpec {
  std::string field;
  std::vector<std::string> values;
};

enum class ViewPolicy { separate, together };

struct CaseSpec {
  std::string name;
  std::vector<FieldValue> set;
  ViewPolicy views = ViewPolicy::separate;  // each view registered by itself (P13), or all points at once
};

// Trials until the statement has stabilised (JCGM 101, 7.9).
struct ToleranceSpec {
  std::string quantity;
  int significant_digits = 2;      // of its standard uncertainty, or
  std::optional<double> absolute;  // this, in the unit of the quantity
  std::uint64_t maximum_trials = 1000000;
};

enum class BudgetMethod { one_at_a_time, sobol };

// Surfaces as in inspection/surface_selection.h, and where in the file they are named.
struct SurfaceTexts {
  std::vector<std::string> texts;
  std::string place;
};

struct ProfileQuantity {
  std::string name;
  SurfaceTexts surfaces;  // none: all
};

struct StudySpec {
  std::filesystem::path file;
  std::string name;
  std::string description;
  std::filesystem::path scenario;
  std::uint64_t seed = 1;
  std::uint64_t trials = 1000;
  std::optional<ToleranceSpec> tolerance;
  std::uint64_t block = 0;  // of trials for the stopping rule; 0: as JCGM 101, 7.9.4
  double coverage_probability = 0.95;
  std::vector<FieldValue> set;   // for all cases
  std::vector<CaseSpec> cases;   // empty: the scenario as it is
  std::vector<SweepSpec> sweep;  // every case with every combination of values
  std::vector<BudgetMethod> budget;
  // Of the running estimate, the budget and the plots; not given: the first of `quantities`.
  std::string headline;
  std::vector<std::string> quantities;    // to keep beside those always kept; empty: all
  SurfaceTexts surfaces;                  // whose deviation error is kept by itself
  std::vector<ProfileQuantity> profiles;  // profile of a surface, each over its surfaces
};

// Throws InputError naming file and line. Paths in the file are relative to its folder.
StudySpec read_study(const std::filesystem::path& file);

// One way of measuring that every trial goes through.
struct StudyCase {
  std::string name;
  Scenario scenario;
  ViewPolicy views = ViewPolicy::separate;
  std::vector<FieldValue> set;            // what sets it apart from the others, sweeps included
  std::vector<std::string> sweep_values;  // one for each sweep
  // What the case is for, when the budget added it: the source that is alone in it, or drawn anew in it.
  enum class Role { given, only_source, all_anew, source_anew } role = Role::given;
  std::string source;
};

// The cases of the study: those given, times the sweeps, then those that the budget of the first case needs.
// Throws InputError naming the study's file and what is wrong with a field or its value.
std::vector<StudyCase> cases_of(const StudySpec& study);

// Error sources of a scenario that are not silent, by the names of the budget: those of the machine,
// "sensor", "form".
std::vector<std::string> active_sources(const Scenario& scenario);

}  // namespace trueblade
