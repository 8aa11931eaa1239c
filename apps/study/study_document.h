// The statement of a study: everything that study.json holds and the HTML page shows.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/study/run_study.h"

namespace trueblade {

// docs/studies.md describes the document key by key. Numbers that do not exist are null.
nlohmann::ordered_json study_document(const StudySpec& study, const StudyModel& model, const StudyRun& run,
                                      const TrialStore& store);

// The same as text of at most 150 columns: everything but histograms and other curves.
std::string study_text(const nlohmann::ordered_json& document);

// One row for each trial and case.
void write_trials_csv(const std::filesystem::path& file, const StudyModel& model, const StudyRun& run,
                      const TrialStore& store);

// A page that opens without a network.
void write_study_page(const std::filesystem::path& file, const nlohmann::ordered_json& document);

}  // namespace trueblade
