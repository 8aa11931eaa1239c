// Scan plans and what comes of them: where the probe goes to cover one view of the part, and the samples it
// brings back. plan_view.h makes a plan, execute_plan.h carries it out, scan_file.h keeps the result.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/scan_points.h"
#include "hardware/lens.h"
#include "hardware/machine_geometry.h"
#include "hardware/point_access.h"

namespace trueblade {

struct PlannedLine {
  std::vector<AxisPositions> approach;  // moved through first, without measuring
  std::vector<AxisPositions> path;      // one sample at each position
};

// What the beam meets at a planned position, on the nominal part.
struct PlannedPoint {
  std::uint32_t surface;
  double range_mm;
  double incidence_cosine;
};

struct ScanPlan {
  std::string view;
  double theta_rad = 0.0;
  std::size_t columns = 0, rows = 0;      // the organised grid of the view; columns run in the fast direction
  std::vector<PlannedLine> lines;         // rows without a visible surface have none
  std::vector<AxisPositions> retreat;     // moved through at the end: away from the part, free to turn it
  std::vector<std::uint32_t> grid_index;  // per planned position in order, its cell row * columns + column
  std::vector<PlannedPoint> points;       // per planned position in order
  // Raster cells on a chosen surface by what became of them: measurable ones are planned.
  std::array<std::size_t, kPointAccessCount> cells{};

  std::size_t point_count() const;
};

// One measured view: every sample in the order taken, with the grid cell it belongs to.
struct ViewScan {
  std::string view;
  double theta_rad = 0.0;
  std::size_t columns = 0, rows = 0;
  std::vector<ProbeSample> samples;
  std::vector<std::uint32_t> grid_index;
  std::vector<std::uint32_t> usable;  // numbers of the samples that became points
  ScanPoints points;                  // of the usable samples, MCS
  double time_s = 0.0;                // on the machine's clock
  bool complete = false;              // false: interrupted, the samples end early
};

}  // namespace trueblade
