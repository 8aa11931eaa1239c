// The organised range image of one view: a grid of the scan plan's cells with what was measured and found in
// each. Rows are scan lines, columns positions along the line.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hardware/scan_plan.h"
#include "inspection/deviations.h"
#include "inspection/result.h"

namespace trueblade {

struct RangeChannel {
  std::string name;
  std::vector<float> values;  // rows * columns, row by row
};

struct RangeImage {
  std::size_t columns = 0;
  std::size_t rows = 0;
  // range (mm along the beam), snr, incidence (rad, between beam and nominal normal), deviation (mm),
  // true_deviation (mm, simulation only), normal.x .y .z (PCS), surface (id), x y z (mm, PCS), outlier (0 or
  // 1), mask (1: a point, 0: none). Cells without a point hold NaN in all others.
  std::vector<RangeChannel> channels;
  RigidTransform part_from_mcs;  // the registered pose
  std::string view;
  std::string program_version;
  std::string scenario;
  std::uint64_t seed = 0;

  const RangeChannel* find(const std::string& name) const;  // nullptr when absent
};

// Precondition: `deviations` are those of view.points. `beam_mcs`: the unit beam direction of the view.
// The colours are those of run.colour_map; precondition: run.colour_limit_mm > 0. `true_deviation_mm`: of the
// true part at each point; empty where it is not known. Throws InputError when the numbers of points disagree
// or a cell lies outside the grid. When a cell was measured twice, the later sample stands.
RangeImage range_image_of(const ViewScan& view, const Deviations& deviations,
                          const RigidTransform& part_from_mcs, const RunFacts& run, const Vec3& beam_mcs,
                          std::span<const double> true_deviation_mm = {});

}  // namespace trueblade
