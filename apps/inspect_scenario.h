// The main job: scan on the scenario's backend, register every view by itself (P13), evaluate, report.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/scenario.h"
#include "inspection/result.h"

namespace trueblade {

struct InspectionRun {
  InspectionResult result;
  bool interrupted = false;  // by Ctrl-C; the views that were finished are in the result
};

// With `run_folder`, writes resolved.yaml, the journal of the scan (scan.journal) as it is measured, then
// scan_<view>.ply as soon as a view is measured, then for each view deviations_<view>.ply, <view>.exr and
// <view>.png, the pictures of the part as a whole (pictures/), then result.json (a folder without it holds no
// result) and last the report made from all that. A view that cannot be measured or registered says why in
// its result; the others go on. The files of an earlier run in the folder are replaced; with `resume`, the
// scan in its journal is gone on with. Throws InputError, MachineFault.
InspectionRun inspect_scenario(const Scenario& scenario,
                               const std::optional<std::filesystem::path>& run_folder, bool resume = false);

}  // namespace trueblade
