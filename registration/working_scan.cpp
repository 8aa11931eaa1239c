#include "registration/working_scan.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

WorkingScan prepare_scan(const ScanPoints& scan, const WeightOptions& options) {
  check_points(scan);
  if (scan.snr.empty() && options.minimum_snr > 0.0)
    throw InputError(fmt::format("weights.minimum_snr is {}, but the scan has no SNR", options.minimum_snr));
  const bool weighted = options.source == WeightSource::snr && !scan.snr.empty();
  WorkingScan result;
  result.scan_index = spatial_order(scan.position_mcs_mm);
  if (!scan.snr.empty())
    std::erase_if(result.scan_index, [&](std::uint32_t i) {
      return scan.snr[i] < options.minimum_snr || (weighted && scan.snr[i] == 0.0);
    });
  const std::size_t count = result.scan_index.size();
  result.position_mcs_mm.resize(count);
  result.weight.assign(count, 1.0);
  for (std::size_t k = 0; k < count; ++k) {
    result.position_mcs_mm[k] = scan.position_mcs_mm[result.scan_index[k]];
    if (weighted) result.weight[k] = scan.snr[result.scan_index[k]];
  }
  if (scan.size() < 3)
    throw InputError(fmt::format("the scan has {} points; at least three are needed", scan.size()));
  if (result.size() < 3)
    throw InputError(
        fmt::format("{} of {} scan points have weight at weights.minimum_snr {}; at least three are needed",
                    result.size(), scan.size(), options.minimum_snr));
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
  ScanExtent extent;
  double weight = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    extent.centroid_mcs_mm += scan.weight[i] * scan.position_mcs_mm[i];
    weight += scan.weight[i];
  }
  extent.centroid_mcs_mm /= weight;
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Vec3 p = scan.position_mcs_mm[i] - extent.centroid_mcs_mm;
    const Vec3 wp = scan.weight[i] * p;
    xx += wp.x() * p.x();
    xy += wp.x() * p.y();
    xz += wp.x() * p.z();
    yy += wp.y() * p.y();
    yz += wp.y() * p.z();
    zz += wp.z() * p.z();
    largest = std::max(largest, p.squaredNorm());
  }
  extent.moment_mm2 << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  extent.moment_mm2 /= weight;
  extent.radius_mm = std::sqrt(extent.moment_mm2.trace());
  extent.maximum_radius_mm = std::sqrt(largest);
  return extent;
}

void check_not_collinear(const ScanExtent& extent) {
  // The centroid of equal points is off by the rounding of their sum.
  const double rounding_mm = 64.0 * std::numeric_limits<double>::epsilon() * extent.centroid_mcs_mm.norm();
  if (!(extent.maximum_radius_mm > rounding_mm))
    throw InputError("all scan points lie in one place; at least three non-collinear points are needed");
  const Vec3 spread =
      Eigen::SelfAdjointEigenSolver<Mat3>(extent.moment_mm2, Eigen::EigenvaluesOnly).eigenvalues();
  // 1e-12 in the square is one millionth of the extent: a hundred times the rounding of coordinates that are
  // ten times as large as the extent.
  if (!(spread[1] > 1e-12 * spread[2]))
    throw InputError("the scan points lie on one line; at least three non-collinear points are needed");
}

}  // namespace trueblade
