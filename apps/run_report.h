// The report of a run, from what its folder holds: the same files whether the inspection has just ended or
// the folder is old.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "part/part.h"

namespace trueblade {

// Writes report.html, statistics.csv and features.csv. `part`: that of the run; nullptr: made again from
// resolved.yaml. What cannot be read is left out of the report, which says so; returns these messages. Throws
// InputError when result.json cannot be read or the folder cannot be written.
std::vector<std::string> write_run_report(const std::filesystem::path& folder, const Part* part);

}  // namespace trueblade
