#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>

#include "apps/study/study_document.h"
#include "geometry/atomic_file.h"

namespace trueblade {
namespace {

// Commas and quotes inside quotes, quotes doubled (RFC 4180).
std::string csv_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

}  // namespace

void write_trials_csv(const std::filesystem::path& file, const StudyModel& model, const StudyRun& run,
                      const TrialStore& store) {
  write_file_atomically(file, [&](std::ostream& out) {
    out << "trial,case,failure";
    for (const Quantity& quantity : model.quantities()) out << ',' << quantity.name;
    out << '\n';
    store.for_each(run.trials, [&](const Outcome& outcome) {
      fmt::print(out, "{},{},{}", outcome.trial, csv_text(model.cases()[outcome.case_number].name),
                 outcome.failure.empty() ? "" : csv_text(outcome.failure));
      for (const double value : outcome.values)
        out << ',' << (std::isnan(value) ? "" : fmt::format("{}", value));
      out << '\n';
    });
  });
}

}  // namespace trueblade
