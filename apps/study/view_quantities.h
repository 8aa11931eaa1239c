// The quantities that a study keeps of one registered view.
#pragma once

#include <vector>

#include "apps/study/study_spec.h"
#include "hardware/scan_plan.h"
#include "registration/result.h"
#include "registration/target.h"
#include "sim/simulated_machine.h"
#include "sim/study/trial.h"

namespace trueblade {

struct SelectedProfile {
  std::string name;
  std::vector<std::uint32_t> surfaces;  // none: all
  bool operator==(const SelectedProfile&) const = default;
};

// The surfaces of a part that the study names.
struct SelectedSurfaces {
  std::vector<std::uint32_t> surfaces;  // in the order of the file
  std::vector<SelectedProfile> profiles;
  bool operator==(const SelectedSurfaces&) const = default;
};

// Throws InputError naming file, line and surface when the part has no such surface.
SelectedSurfaces selected_surfaces(const StudySpec& study, const Part& part);

// What can be kept of every view, in a fixed order; names without the view.
std::vector<Quantity> view_quantities(const SelectedSurfaces& selected);

// Of these, what no list of quantities drops: what the comparison with theory is made of, and what the
// study's `surfaces` ask for.
bool is_always_kept(const std::string& view_quantity);

// A usable sample, as the evaluation of a study needs it.
struct TruePoint {
  Vec3 measured_mcs_mm;
  double snr;
  TrueHit hit;
};

// The points of one registered scan, be it of one view or of several together.
struct RegisteredPoints {
  std::vector<TruePoint> points;
  RigidTransform true_part_from_mcs;
};

// The values of view_quantities, NaN where a quantity does not exist. `wanted`: which of them; the costly
// ones are left out otherwise. `model` is the facet model of the true part, to which the hits belong.
std::vector<double> values_of_view(const SelectedSurfaces& selected, const Scenario& scenario,
                                   const RegistrationTarget& target, const FacetModel& model,
                                   const RegisteredPoints& registered, const ScanPoints& scan,
                                   const RegistrationResult& result, const std::vector<bool>& wanted);

}  // namespace trueblade
