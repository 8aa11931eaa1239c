// What is found out about the part from all views together: joint registration, profiles, blade sections,
// groups of surfaces against one another.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inspection/deviations.h"
#include "inspection/measure_section.h"
#include "inspection/pose_difference.h"
#include "inspection/profile.h"
#include "inspection/profile_stretches.h"
#include "inspection/statistics.h"
#include "registration/options.h"
#include "registration/target.h"

namespace trueblade {

// Surfaces as the user names them, see surface_selection.h.
struct ProfileSpec {
  std::string name;
  std::vector<std::string> surfaces;  // empty: all
  Tolerance tolerance{-0.05, 0.05};
};

struct GroupSpec {
  std::string name;
  std::vector<std::string> surfaces;
};

struct EvaluationSpec {
  std::vector<ProfileSpec> profiles;
  std::optional<SectionsSpec> sections;
  // The first group is what the others are compared with.
  std::vector<GroupSpec> groups;
  std::vector<std::uint32_t> datum_surfaces;  // empty: best fit
  bool views_on_datum = false;                // the views' own registrations are on these surfaces already
  double point_uncertainty_mm = 0.0;          // standard, of one measured distance
};

struct ScanOfView {
  std::string name;
  const ScanPoints* scan;
  const RegistrationResult* registration;
  const Deviations* deviations;
};

struct JointView {
  std::string view;
  DeviationStatistics statistics;  // of the view's points at the joint pose
  PoseDifference alone;            // the view by itself, from the joint fit
  std::size_t first_point = 0;     // of the view in JointResult::deviations
};

// All views as one scan: their points share the measurement frame, which turns with the rotary table, so that
// the rotary angles tie them together.
struct JointResult {
  RegistrationResult registration;
  Deviations deviations;  // of all points at the joint pose, view after view
  DeviationStatistics statistics;
  std::vector<JointView> views;
  std::vector<PoseDifference> between_views;  // each view from the first, each registered by itself
};

struct GroupFit {
  std::string name;
  std::size_t points = 0;  // that took part
  double rms_mm = kNoValue;
};

struct EvaluationResult {
  std::optional<JointResult> joint;           // see evaluate_together
  std::vector<std::uint32_t> datum_surfaces;  // those of the specification
  std::vector<ProfileResult> profiles;
  std::vector<SectionResult> sections;
  std::vector<std::vector<ProfileStretch>> section_profiles;  // of each section, along its outline
  std::vector<GroupFit> groups;
  std::vector<PoseDifference> offsets;  // each group from the first
  // What was asked for and could not be made, and why, one sentence each.
  std::vector<std::string> missing;
  // Features of measured sections without a number: "section at 60 mm: no chord (reason)".
  std::vector<std::string> missing_features;
};

// Profiles, sections and offsets take all points at the joint pose where there is more than one view, or one
// that has yet to be fitted to the datum surfaces, else the only view at its own. `views` are those that were
// registered; none: everything is missing. What fails is put into `missing` and the rest is made.
EvaluationResult evaluate_together(const EvaluationSpec& spec, const RegistrationTarget& target,
                                   const RegistrationOptions& options, DeviationSurface surface,
                                   const std::vector<ScanOfView>& views);

}  // namespace trueblade
