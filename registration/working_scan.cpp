#include "registration/working_scan.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "geometry/spatial_order.h"

namespace trueblade {
namespace {

void check_points(const ScanPoints& scan) {
  if (!scan.snr.empty() && scan.snr.size() != scan.size())
    throw InputError(fmt::format("the scan has {} points but {} SNR values", scan.size(), scan.snr.size()));
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Vec3& p = scan.position_mcs_mm[i];
    if (!p.allFinite())
      throw InputError(
          fmt::format("scan point {} is ({}, {}, {}), coordinates must be finite", i, p.x(), p.y(), p.z()));
    if (!scan.snr.empty() && !(scan.snr[i] >= 0.0 && scan.snr[i] <= 1.0))
      throw InputError(fmt::format("SNR of scan point {} is {}, must be within 0 to 1", i, scan.snr[i]));
  }
}

void check_not_collinear(const WorkingScan& scan, const ScanExtent& extent) {
  Mat3 moment = Mat3::Zero();
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Vec3 p = scan.position_mcs_mm[i] - extent.centroid_mcs_mm;
    moment += scan.weight[i] * p * p.transpose();
  }
  const Vec3 spread = Eigen::SelfAdjointEigenSolver<Mat3>(moment, Eigen::EigenvaluesOnly).eigenvalues();
  // 1e-12 in the square is one millionth of the extent: a hundred times the rounding of coordinates that are
  // ten times as large as the extent.
  if (!(spread[1] > 1e-12 * spread[2]))
    throw InputError("the scan points lie on one line; at least three non-collinear points are needed");
}

}  // namespace

WorkingScan prepare_scan(const ScanPoints& scan, const WeightOptions& options) {
  check_points(scan);
  const bool weighted = options.source == WeightSource::snr && !scan.snr.empty();
  WorkingScan result;
  result.position_mcs_mm.reserve(scan.size());
  result.weight.reserve(scan.size());
  result.scan_index.reserve(scan.size());
  for (const std::uint32_t i : spatial_order(scan.position_mcs_mm)) {
    const double weight = weighted ? scan.snr[i] : 1.0;
    const bool dropped = !scan.snr.empty() && scan.snr[i] < options.minimum_snr;
    if (dropped || weight == 0.0) continue;
    result.position_mcs_mm.push_back(scan.position_mcs_mm[i]);
    result.weight.push_back(weight);
    result.scan_index.push_back(i);
  }
  if (result.size() < 3)
    throw InputError(
        fmt::format("{} of {} scan points have weight at weights.minimum_snr {}; at least three are needed",
                    result.size(), scan.size(), options.minimum_snr));
  check_not_collinear(result, extent_of(result));
  return result;
}

WorkingScan even_subsample(const WorkingScan& scan, std::size_t count) {
  WorkingScan result;
  const std::size_t stride = std::max<std::size_t>(1, scan.size() / count);
  const std::size_t first = stride / 2;
  for (std::size_t i = first; i < scan.size(); i += stride) {
    result.position_mcs_mm.push_back(scan.position_mcs_mm[i]);
    result.weight.push_back(scan.weight[i]);
    result.scan_index.push_back(scan.scan_index[i]);
  }
  return result;
}

ScanExtent extent_of(const WorkingScan& scan) {
  ScanExtent extent{Vec3::Zero(), 0.0, 0.0};
  double weight = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    extent.centroid_mcs_mm += scan.weight[i] * scan.position_mcs_mm[i];
    weight += scan.weight[i];
  }
  extent.centroid_mcs_mm /= weight;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const double squared = (scan.position_mcs_mm[i] - extent.centroid_mcs_mm).squaredNorm();
    extent.radius_mm += scan.weight[i] * squared;
    extent.maximum_radius_mm = std::max(extent.maximum_radius_mm, squared);
  }
  extent.radius_mm = std::sqrt(extent.radius_mm / weight);
  extent.maximum_radius_mm = std::sqrt(extent.maximum_radius_mm);
  return extent;
}

}  // namespace trueblade
