#include "registration/working_scan.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/error.h"

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

// The points along a space-filling (Z-order) curve through their bounding box.
std::vector<std::uint32_t> spatial_order(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  if (points.empty()) return order;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double scale = 1023.0 / std::max((high - low).maxCoeff(), 1e-300);
  const auto spread = [](std::uint32_t v) {
    v = (v | (v << 16)) & 0x030000FF;
    v = (v | (v << 8)) & 0x0300F00F;
    v = (v | (v << 4)) & 0x030C30C3;
    return (v | (v << 2)) & 0x09249249;
  };
  std::vector<std::uint32_t> code(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 cell = (points[i] - low) * scale;
    code[i] = spread(static_cast<std::uint32_t>(cell.x())) |
              spread(static_cast<std::uint32_t>(cell.y())) << 1 |
              spread(static_cast<std::uint32_t>(cell.z())) << 2;
  }
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return code[a] < code[b]; });
  return order;
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
