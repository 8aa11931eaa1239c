// What an inspection found, as plain structs: apps fills them, the writers of this folder read them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid_transform.h"
#include "inspection/colour_map.h"
#include "inspection/evaluation.h"
#include "inspection/statistics.h"
#include "inspection/tolerance.h"
#include "registration/result.h"

namespace trueblade {

// The recipe of the run: with it the result can be made again.
struct RunFacts {
  std::string program_version;  // with the commit where it is known
  std::string scenario;
  std::uint64_t seed = 0;
  std::string date;  // ISO 8601, empty when not stated
  std::string machine;
  std::string lens;
  std::string part;                    // name or file
  std::size_t surfaces = 0;            // CAD surfaces of the part
  std::size_t facets = 0;              // of its facet model
  std::string registration_preset;     // "default", "zhu2007" ...
  std::string rejection_rule;          // of the registration; the report's rule is its own, see statistics.h
  std::string deviations_from;         // "exact" or "facets"
  double colour_limit_mm = 0.0;        // ends of the colour scale
  std::optional<Tolerance> tolerance;  // of all deviations
  ColourMap colour_map = ColourMap::blue_green_red;
};

// Registered against true pose. The translation error is the displacement of the scan centroid, because the
// translation itself depends on where the origin lies.
struct PoseError {
  RigidTransform true_part_from_mcs;
  double translation_error_mm = 0.0;
  double rotation_error_rad = 0.0;
  // Form of the part that was measured, over the points of the report (outliers left out): root mean square
  // of its true deviation from the nominal part, and of reported less true deviation. No value where it is
  // not known.
  double true_deviation_rms_mm = kNoValue;
  double deviation_error_rms_mm = kNoValue;
};
PoseError pose_error(const RigidTransform& part_from_mcs, const RigidTransform& true_part_from_mcs,
                     const Vec3& centroid_mcs_mm);

struct ViewTimes {
  double scan_s = kNoValue;  // on the machine's clock
  double register_s = kNoValue;
  double evaluate_s = kNoValue;
};

struct SurfaceStatistics {
  std::uint32_t surface = 0;
  std::string name;
  DeviationStatistics statistics;
  std::optional<ToleranceCounts> tolerance;  // against RunFacts::tolerance, without report outliers
  DeviationStatistics from_facets;           // the same points, against the facet model
};

struct ViewResult {
  std::string view;
  double theta_rad = 0.0;
  std::size_t planned = 0;  // samples asked for; those without a usable distance are no points
  std::size_t out_of_range = 0;
  std::size_t missed = 0;
  std::size_t low_signal = 0;        // of the points
  std::string failure;               // why the view was not registered at all; all that follows is then empty
  double initial_rms_mm = kNoValue;  // distance of all points from the facets at the pose of the set-up
  RegistrationResult registration;
  DeviationStatistics statistics;   // of the signed deviations, report outliers left out
  DeviationStatistics from_facets;  // the same points, against the facet model
  std::optional<ToleranceCounts> tolerance;
  std::vector<SurfaceStatistics> surfaces;  // of the surfaces that were measured
  ViewTimes time;
  std::optional<PoseError> truth;  // in simulation
};

struct InspectionResult {
  RunFacts run;
  std::vector<ViewResult> views;
  EvaluationResult evaluation;
};

}  // namespace trueblade
