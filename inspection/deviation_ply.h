// The measured points with their deviations as a binary PLY that CloudCompare and MeshLab show coloured.
#pragma once

#include <filesystem>

#include "inspection/deviations.h"
#include "inspection/result.h"

namespace trueblade {

// The same points at the pose of all views together: entries `first` and on of `all`.
struct PointsTogether {
  const Deviations* all = nullptr;
  std::size_t first = 0;
};

// Vertices in the order of the scan: x y z (double, mm, PCS), scalar_deviation (float, mm), scalar_snr
// (float; NaN when the scan has none), red green blue (outliers black), surface (int), outlier (0 or 1); with
// `together` also scalar_deviation_together (float, mm) and outlier_together (0 or 1), at that pose. Comments
// state unit, frame, view and program. Throws InputError when the file cannot be written.
void write_deviation_ply(const std::filesystem::path& file, const Deviations& deviations,
                         const std::string& view, const RunFacts& run, const PointsTogether& together = {});

}  // namespace trueblade
