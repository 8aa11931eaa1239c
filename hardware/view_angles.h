// Choice of rotary angles that together see the chosen surfaces: greedy set cover over sample points.
#pragma once

#include "hardware/coverage.h"
#include "hardware/plan_view.h"

namespace trueblade {

struct ViewAngleOptions {
  double candidate_step_rad = 0.17453292519943295;  // 10 degrees: a tenth of the usual incidence allowance
  std::size_t most_views = 12;
  double least_gain = 0.005;        // a further view must add this share of the area
  std::size_t sample_count = 8000;  // shares of the area to 0.6 %, one standard error at worst

  void validate() const;  // throws InputError naming the value and the constraint
};

struct ViewChoice {
  std::vector<double> theta_rad;  // in the order of choice: each sees the most of what was not yet seen
  Coverage coverage;              // of these views
  double coverable;               // share of the area that all candidates together see
};

// Candidates are the angles of the full turn within `limits`. Of angles that see as much, the one first in
// the turn is taken. `surfaces` and incidence as in `plan`; its view and angle are not used.
// Throws InputError when no candidate sees anything of the chosen surfaces.
ViewChoice choose_view_angles(const MachineGeometry& geometry, const Lens& lens, const AxisLimits& limits,
                              const Part& nominal, const RayCaster& nominal_caster,
                              const RigidTransform& part_from_mcs, const PlanOptions& plan,
                              const ViewAngleOptions& options);

// The coverage of given views, for plans whose angles the user states.
Coverage coverage_of_views(const MachineGeometry& geometry, const Lens& lens, const Part& nominal,
                           const RayCaster& nominal_caster, const RigidTransform& part_from_mcs,
                           const PlanOptions& plan, std::span<const double> theta_rad,
                           std::size_t sample_count);

}  // namespace trueblade
