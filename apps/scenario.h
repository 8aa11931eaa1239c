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
#include "apps/machine_fields.h"
#include "apps/part_fields.h"
#include "apps/registration_fields.h"
#include "apps/yaml_reader.h"
#include "hardware/view_angles.h"
#include "inspection/colour_map.h"
#include "inspection/deviations.h"

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
  std::vector<std::uint32_t> surfaces;      // CAD surfaces to measure; empty: all
  std::optional<double> max_incidence_rad;  // default: the lens's own limit
};

struct InspectionSpec {
  DeviationSurface surface = DeviationSurface::exact;
  std::optional<std::pair<double, double>> tolerance_mm;  // lower, upper
  std::optional<double> colour_limit_mm;  // default: from the RMS, see rounded_colour_limit_mm
  ColourMap colour_map = ColourMap::blue_green_red;
};

struct Scenario {
  std::string name;  // as view names; the run folder is called after it
  std::string description;
  std::uint64_t seed = 1;
  std::uint64_t trial = 0;  // which draw of the errors; trial N of a study with this seed
  PartSpec part;
  MachineSpec machine;
  ScanSpec scan;
  RegistrationSpec registration;
  InspectionSpec inspection;
  std::map<std::string, ViewExpectation> expect;  // by view
};

// Throws InputError naming file and line. Paths in the file are relative to its folder. A scenario without a
// name is called after its file.
Scenario read_scenario(const std::filesystem::path& file, const std::vector<YamlOverride>& overrides = {});

// The whole scenario with its defaults; reads back to the same scenario.
std::string scenario_text(const Scenario& scenario);

}  // namespace trueblade
