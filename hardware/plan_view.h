// Plans one view: an organised raster in the plane normal to the beam, at one rotary angle. At every raster
// position the probe stands so far from the nominal surface that the range is the lens's standoff: the 25 mm
// lens has 0.7 mm of working range, so the probe follows the shape. The housing keeps its clearance all the
// way: where it cannot go straight from one position to the next, it first withdraws along the beam.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/error.h"
#include "geometry/ray_caster.h"
#include "hardware/lens.h"
#include "hardware/machine_geometry.h"
#include "hardware/scan_plan.h"
#include "part/part.h"

namespace trueblade {

struct PlanOptions {
  std::string view = "front";
  double theta_rad = 0.0;
  double spacing_mm = 1.0;                  // of the raster, in both directions
  std::vector<std::uint32_t> surfaces;      // CAD surfaces to measure; empty: all
  std::optional<double> max_incidence_rad;  // angle between beam and normal; default: the lens's own limit
  // By so much the rows are measured in turn nearer than the standoff, at it, and farther. A calibration
  // learns the beam's direction from the difference.
  double standoff_spread_mm = 0.0;
  ProbeBody probe;

  // Throws InputError naming the value and the constraint.
  void validate(const Part& part, const Lens& lens) const;
};

// The view can see none of the chosen surfaces, or reach them; its raster is too coarse for them; or no light
// would come back.
class NothingToMeasure : public InputError {
 public:
  using InputError::InputError;
};

// Raster of the nominal part's silhouette along the beam: columns across the rotary axis, rows along it
// (when the beam is along the rotary axis: along the machine's axes). A cell is measured when the first
// surface that the beam meets there is one of the chosen and the probe has access to it (point_access.h).
// Lines run along rows; they are measured in the order of least travel, nearest end first.
// The plan begins and ends with the probe withdrawn so far that the table can turn.
// `nominal_caster` casts on nominal.model. The plan does not depend on the number of threads.
// Throws InputError when the raster would exceed 10^8 cells, and NothingToMeasure, whose message counts the
// reasons.
ScanPlan plan_view(const MachineGeometry& geometry, const Lens& lens, const Part& nominal,
                   const RayCaster& nominal_caster, const RigidTransform& part_from_mcs,
                   const PlanOptions& options);

}  // namespace trueblade
