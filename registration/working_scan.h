// The scan as the iterations use it: checked, weighted, filtered by SNR (P8) and in spatial order, so that
// neighbouring queries touch neighbouring parts of the search tree.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/scan_points.h"
#include "registration/options.h"

namespace trueblade {

struct WorkingScan {
  std::vector<Vec3> position_mcs_mm;
  std::vector<double> weight;             // at least 0
  std::vector<std::uint32_t> scan_index;  // of each point in the caller's scan

  std::size_t size() const { return position_mcs_mm.size(); }
};

// Throws InputError for positions that are not finite, SNR out of [0, 1] or not one per point, and when the
// filter leaves fewer than three points with weight.
WorkingScan prepare_scan(const ScanPoints& scan, const WeightOptions& options);

// About `count` points, every n-th in spatial order: as even over the scan as the scan itself.
WorkingScan even_subsample(const WorkingScan& scan, std::size_t count);

// Weighted centroid in MCS and the extent about it.
struct ScanExtent {
  Vec3 centroid_mcs_mm = Vec3::Zero();
  Mat3 moment_mm2 = Mat3::Zero();  // mean of p p', p from the centroid
  double radius_mm = 0.0;          // root mean square distance from the centroid, weighted
  double maximum_radius_mm = 0.0;  // largest distance from the centroid
};
ScanExtent extent_of(const WorkingScan& scan);

// Throws InputError when the points lie on one line or in one place.
void check_not_collinear(const ScanExtent& extent);

}  // namespace trueblade
