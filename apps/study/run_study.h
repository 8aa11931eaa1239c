// Runs the trials of a study and keeps them in its store.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/study/ranks.h"
#include "apps/study/study_model.h"
#include "sim/study/stopping_rule.h"
#include "sim/study/trial_store.h"

namespace trueblade {

// What the results belong to: everything that an outcome depends on, and the program.
StudyIdentity identity_of(const StudyModel& model);

struct StudyRun {
  TrialRange trials;  // that the statement is about
  bool interrupted = false;
  struct Stopping {
    bool stable = false;
    std::string quantity;
    std::size_t blocks = 0;
    std::uint64_t block_size = 0;
    double tolerance = 0.0;
    double largest_twice_standard_error = 0.0;
    double trials_expected = 0.0;  // what the scatter of the blocks suggests
  };
  std::optional<Stopping> stopping;  // when the study has a tolerance
};

// Evaluates what the store does not hold yet of `range`, or, without one, of the study's own trials: their
// number, or as many blocks as its tolerance needs. Progress goes to standard error. Ctrl-C ends it with all
// finished trials kept. Throws InputError when nothing but failures comes of a case.
StudyRun run_study(const StudySpec& study, const StudyModel& model, const std::optional<TrialRange>& range,
                   TrialStore& store, Ranks& ranks);

// Place of a quantity in the model's list by its full name or, of the first view that has it, its own; the
// headline's default is the first one of the list.
std::size_t quantity_number(const StudyModel& model, const std::string& name);

}  // namespace trueblade
