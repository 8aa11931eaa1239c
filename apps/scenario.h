// A scenario: everything an inspection depends on, as one YAML file. An inspection is a function of the
// scenario and its seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/expectation.h"
#include "apps/inspection_fields.h"
#include "apps/machine_fields.h"
#include "apps/part_fields.h"
#include "apps/registration_fields.h"
#include "apps/yaml_reader.h"
#include "hardware/view_angles.h"

namespace trueblade {

struct ViewSpec {
  std::string name;  // letters, digits, _ and -: it becomes part of file names
  double theta_rad = 0.0;
};

// Either the views are stated, or their angles are chosen for coverage; then they are called theta_<degrees>.
struct ScanSpec {
  std::vector<ViewSpec> views;
  std::optional<ViewAngleOptions> automatic_views;
  double spacing_mm = 1.0;
  double standoff_spread_mm = 0.0;          // see PlanOptions
  std::vector<std::uint32_t> surfaces;      // CAD surfaces to measure; empty: all
  std::optional<double> max_incidence_rad;  // default: the lens's own limit
};

struct Scenario {
  std::string name;  // as view names; the run folder is called after it
  std::string description;
  std::uint64_t seed = 1;
  std::uint64_t trial = 0;  // which draw of the errors; trial N of a study with this seed
  PartSpec part;
  std::optional<PartSpec> part_on_table;  // simulated only: another part than the nominal one
  MachineSpec machine;
  ScanSpec scan;
  RegistrationSpec registration;
  InspectionSpec inspection;
  std::map<std::string, ViewExpectation> expect;  // by view
  std::string expect_error;  // words of the message with which the scenario is expected to be refused
  std::map<std::string, PartExpectation> expect_part;  // by the names of judge_part
};

// What a scenario promises of its own inspection (expect, expect_part, expect_error) says nothing of another.
void drop_expectations(Scenario& scenario);

// Throws InputError naming file and line. Paths in the file are relative to its folder. A scenario without a
// name is called after its file. With overrides it is another one: its expectations are dropped.
Scenario read_scenario(const std::filesystem::path& file, const std::vector<YamlOverride>& overrides = {});

// The whole scenario with its defaults; reads back to the same scenario.
std::string scenario_text(const Scenario& scenario);

}  // namespace trueblade
