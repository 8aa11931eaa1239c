// The quantities that a study keeps of the part as a whole: errors of what the inspection block of the
// scenario asks for, features of blade sections and offsets between groups of surfaces, and of the study's
// own profiles.
//
//   part.section_HEIGHT_FEATURE_error_UNIT        features as in kSectionFeatures
//   part.offset_GROUP_COMPONENT_error_UNIT        of every group but the first, from the first
//   part.profile_NAME_error_mm                    of every profile of the study
//
// Errors are measured minus true. The true features are those of the nominal outline displaced as the form
// errors say (KnownSection). The true offset is the rigid displacement, by least squares, of the true surface
// at the measured points of either group. The true profile is twice the largest true deviation, either side,
// of the measured points.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/view_quantities.h"
#include "inspection/evaluation.h"
#include "inspection/known_section.h"

namespace trueblade {

// Names without "part."; empty when neither the study nor the scenario asks for any.
std::vector<Quantity> part_quantities(const StudySpec& study, const Scenario& scenario);

class PartMeasurands {
 public:
  // `wanted`: names of part_quantities; what none of them needs is not measured. `profiles`: the surfaces of
  // the study's. `fixed_part`: the virtual part, where it is the same in every trial. Keeps a reference to
  // the target. Throws InputError when a section misses the part or the part on the table is another one,
  // whose true features nobody knows.
  PartMeasurands(const RegistrationTarget& target, const StudySpec& study, const Scenario& scenario,
                 const std::vector<SelectedProfile>& profiles, const std::vector<std::string>& wanted,
                 const std::optional<VirtualPart>& fixed_part);

  // The wanted values by name, of all points as one scan at its registered pose; NaN where the inspection has
  // no number. May run from any number of threads.
  std::map<std::string, double> evaluate(const ScanPoints& scan, const RegistrationResult& registration,
                                         const RegisteredPoints& truth, const VirtualPart& part) const;

 private:
  std::vector<SectionResult> known_sections(const VirtualPart& part) const;

  const RegistrationTarget& target_;
  RegistrationOptions options_;
  DeviationSurface surface_;
  EvaluationSpec spec_;
  std::vector<std::string> wanted_;
  std::vector<KnownSection> sections_;
  std::optional<std::vector<SectionResult>> fixed_;  // of a part that is the same in every trial
  std::vector<std::vector<std::uint32_t>> groups_;   // surfaces of each
  std::vector<SelectedProfile> profiles_;
};

}  // namespace trueblade
