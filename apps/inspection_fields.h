// The inspection block of a scenario: what the deviations are taken from, and what is to be found out about
// the part.
#pragma once

#include <optional>
#include <utility>

#include "apps/yaml_fields.h"
#include "inspection/colour_map.h"
#include "inspection/deviations.h"
#include "inspection/evaluation.h"

namespace trueblade {

struct InspectionSpec {
  DeviationSurface surface = DeviationSurface::exact;
  std::optional<std::pair<double, double>> tolerance_mm;  // lower, upper
  std::optional<double> colour_limit_mm;  // default: from the RMS, see rounded_colour_limit_mm
  ColourMap colour_map = ColourMap::blue_green_red;
  std::optional<double> point_uncertainty_mm;  // standard, of one distance; default: the lens's accuracy
  std::vector<std::string> datum_surfaces;     // fitted alone after the best fit; empty: best fit
  std::vector<ProfileSpec> profiles;
  std::optional<SectionsSpec> sections;
  std::vector<GroupSpec> groups;
};

void fields(YamlFields& io, InspectionSpec& inspection);

}  // namespace trueblade
