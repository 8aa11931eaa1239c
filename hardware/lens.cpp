#include "hardware/lens.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Accuracy and working range are the paper's (section 4). Standoff, spot, incidence and rate are not stated
// there: the standoff is taken as the focal length, the others are of the order of the makers' data sheets.
const std::array<Lens, 2>& standard_lenses() {
  static const std::array<Lens, 2> lenses{Lens{.name = "25mm",
                                               .focal_length_mm = 25.0,
                                               .standoff_mm = 25.0,
                                               .working_range_mm = 0.7,
                                               .accuracy_mm = 0.003,
                                               .accuracy_is_limit = false,
                                               .spot_diameter_mm = 0.014,
                                               .max_incidence_rad = 75.0 * kDegree,
                                               .rate_hz = 1000.0,
                                               .verified = true},
                                          Lens{.name = "100mm",
                                               .focal_length_mm = 100.0,
                                               .standoff_mm = 100.0,
                                               .working_range_mm = 70.0,
                                               .accuracy_mm = 0.035,
                                               .accuracy_is_limit = true,
                                               .spot_diameter_mm = 0.063,
                                               .max_incidence_rad = 75.0 * kDegree,
                                               .rate_hz = 1000.0,
                                               .verified = true}};
  return lenses;
}

void require_positive(const std::string& lens, const char* field, double value) {
  if (!(value > 0.0 && std::isfinite(value)))
    throw InputError(fmt::format("lens {}: {} is {}, must be above 0", lens, field, value));
}

}  // namespace

void Lens::validate() const {
  require_positive(name, "focal_length_mm", focal_length_mm);
  require_positive(name, "standoff_mm", standoff_mm);
  require_positive(name, "working_range_mm", working_range_mm);
  require_positive(name, "accuracy_mm", accuracy_mm);
  require_positive(name, "rate_hz", rate_hz);
  if (!(spot_diameter_mm >= 0.0 && std::isfinite(spot_diameter_mm)))
    throw InputError(
        fmt::format("lens {}: spot_diameter_mm is {}, must be at least 0", name, spot_diameter_mm));
  if (!(working_range_mm < 2.0 * standoff_mm))
    throw InputError(
        fmt::format("lens {}: working_range_mm is {}, must be below twice the standoff_mm ({}), or the range "
                    "would reach into the probe",
                    name, working_range_mm, standoff_mm));
  if (!(accuracy_mm < 0.5 * working_range_mm))
    throw InputError(
        fmt::format("lens {}: accuracy_mm is {}, must be below half the working_range_mm ({}), or no reading "
                    "would tell a place within it",
                    name, accuracy_mm, working_range_mm));
  if (!(spot_diameter_mm < standoff_mm))
    throw InputError(fmt::format("lens {}: spot_diameter_mm is {}, must be below the standoff_mm ({})", name,
                                 spot_diameter_mm, standoff_mm));
  if (!(max_incidence_rad > 0.0 && max_incidence_rad < 0.5 * std::numbers::pi))
    throw InputError(fmt::format("lens {}: max_incidence is {} deg, must be above 0 and below 90 deg", name,
                                 max_incidence_rad / kDegree));
}

Lens standard_lens(const std::string& name) {
  std::string known;
  for (const Lens& lens : standard_lenses()) {
    if (lens.name == name) return lens;
    known += (known.empty() ? "" : ", ") + lens.name;
  }
  throw InputError(fmt::format("lens is \"{}\", must be one of {}", name, known));
}

}  // namespace trueblade
