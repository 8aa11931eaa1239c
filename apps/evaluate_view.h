// From a measured view to its result: register, take the deviations, make the statistics.
#pragma once

#include <optional>
#include <string>

#include "geometry/scan_points.h"
#include "inspection/deviations.h"
#include "inspection/result.h"
#include "registration/options.h"
#include "registration/target.h"

namespace trueblade {

struct EvaluatedView {
  ViewResult result;
  Deviations deviations;
};

struct ViewEvaluationOptions {
  RegistrationOptions registration;
  DeviationSurface surface = DeviationSurface::exact;
  std::vector<std::uint32_t> datum_surfaces;  // see register_to_datum
  std::optional<Tolerance> tolerance;         // to count points against
};

// Throws InputError (see register_scan, evaluate_deviations).
EvaluatedView evaluate_view(const RegistrationTarget& target, const std::string& name, const ScanPoints& scan,
                            const RigidTransform& initial_part_from_mcs, const ViewEvaluationOptions& options,
                            const std::optional<RigidTransform>& true_part_from_mcs);

}  // namespace trueblade
