// Every published variant of the registration on one scan, side by side.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/register_scan.h"

namespace trueblade {

struct Variant {
  std::string name;
  RegistrationOptions options;
};

// The paper as published, then with one part exchanged at a time (closest point, cache, acceleration, closed
// form, rejection, rim), then today's default and its parts.
std::vector<Variant> published_variants();

struct VariantResult {
  std::string name;
  RegistrationResult result;
  double time_s = 0.0;  // of register_scan, without the target's set-up
  // Where the true pose is known.
  std::optional<double> rotation_error_rad;
  std::optional<double> centroid_error_mm;  // at the scan centroid
};

// Runs the variants one after the other. `target` is warmed first, so that no variant pays for a structure
// that is built at its first use. Throws InputError as register_scan does.
std::vector<VariantResult> compare_variants(const RegistrationTarget& target, const ScanPoints& scan,
                                            const RigidTransform& initial_part_from_mcs,
                                            const std::optional<RigidTransform>& true_part_from_mcs);

// A Markdown table: iterations, queries, facets tested per query, cache share, time, RMS and pose error.
std::string variants_table(const std::vector<VariantResult>& results);

}  // namespace trueblade
