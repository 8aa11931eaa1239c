// What one trial of a study measures: the scenario scanned on the virtual machine with its errors drawn for
// this trial, registered, evaluated, and held against the truth.
//
// Quantities are named VIEW.NAME_UNIT. Errors are registered minus true. The pose error is the small motion
// (rotation vector, then translation of the scan centroid; moved_about) from the true to the registered pose,
// in the part frame.
#pragma once

#include <memory>
#include <vector>

#include "apps/study/study_spec.h"
#include "sim/study/trial.h"

namespace trueblade {

class StudyModel {
 public:
  // Builds, once for all threads, what the cases need: parts, search trees, scan plans. Throws InputError.
  StudyModel(const StudySpec& study, std::vector<StudyCase> cases);
  ~StudyModel();

  const std::vector<StudyCase>& cases() const { return cases_; }
  const std::vector<Quantity>& quantities() const;

  // Const functions may run from any number of threads.
  std::vector<Outcome> evaluate(std::uint64_t trial) const;
  Outcome evaluate_case(std::uint32_t number, std::uint64_t trial) const;  // one case alone

 private:
  struct Impl;
  std::vector<StudyCase> cases_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trueblade
