#include "inspection/deviations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "part/exact_closest_point.h"

namespace trueblade {
namespace {

// A query costs a few hundred nanoseconds, starting a task about a microsecond: 256 of them hide the start.
constexpr std::size_t kBlock = 256;

// Some scan points in the part frame and the closest points of the facets.
struct QueriedPoints {
  std::vector<Vec3> point_mm;
  std::vector<ClosestPoint> closest;
};

QueriedPoints query_points(const ClosestPointTree& tree, std::span<const Vec3> position_mcs_mm,
                           const RigidTransform& part_from_mcs) {
  const std::size_t n = position_mcs_mm.size();
  QueriedPoints queried{std::vector<Vec3>(n), std::vector<ClosestPoint>(n)};
  const Mat3 rotation = part_from_mcs.rotation.toRotationMatrix();
  for (std::size_t i = 0; i < n; ++i)
    queried.point_mm[i] = rotation * position_mcs_mm[i] + part_from_mcs.translation_mm;
  ClosestPointWork work;
  tree.query(queried.point_mm, queried.closest, {}, work);
  return queried;
}

void check_finite(const ScanPoints& scan, const RigidTransform& part_from_mcs) {
  if (!is_finite(part_from_mcs)) throw InputError("the pose of the scan is not finite");
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.position_mcs_mm[i].allFinite()) throw InputError(fmt::format("scan point {} is not finite", i));
  }
}

Deviations sized(std::size_t n) {
  Deviations d;
  d.point_mm.resize(n);
  d.nominal_mm.resize(n);
  d.normal.resize(n);
  d.signed_mm.resize(n);
  d.from_facets_mm.resize(n);
  d.facet.resize(n);
  d.surface.resize(n);
  return d;
}

}  // namespace

std::string to_string(DeviationSurface surface) {
  return surface == DeviationSurface::facets ? "facets" : "exact";
}

DeviationSurface parse_deviation_surface(const std::string& name) {
  if (name == "facets") return DeviationSurface::facets;
  if (name == "exact") return DeviationSurface::exact;
  throw InputError("deviation surface is '" + name + "', must be facets or exact");
}

Deviations evaluate_deviations(const Part& part, const ClosestPointTree& tree, const PseudoNormals& normals,
                               const ScanPoints& scan, const RigidTransform& part_from_mcs,
                               const DeviationOptions& options) {
  check_finite(scan, part_from_mcs);
  const std::size_t n = scan.size();
  Deviations d = sized(n);
  d.snr = scan.snr;
  std::vector<char> is_exact(n, 0);
  parallel_for_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
    const QueriedPoints queried =
        query_points(tree, std::span(scan.position_mcs_mm).subspan(begin, end - begin), part_from_mcs);
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& point = queried.point_mm[i - begin];
      const ClosestPoint& closest = queried.closest[i - begin];
      d.point_mm[i] = point;
      d.nominal_mm[i] = closest.point_mm;
      d.normal[i] = normals.normal(closest);
      d.from_facets_mm[i] = d.signed_mm[i] = normals.signed_distance_mm(closest, point);
      d.facet[i] = closest.facet;
      d.surface[i] = part.model.surface_of(closest.facet);
      if (options.surface == DeviationSurface::facets) continue;
      if (const auto exact = refine_to_exact(part, closest, point)) {
        d.nominal_mm[i] = exact->foot.point_mm;
        d.normal[i] = exact->foot.normal;
        d.signed_mm[i] = exact->distance_mm;
        d.surface[i] = exact->surface;
        is_exact[i] = 1;
      }
    }
  });
  d.exact = static_cast<std::size_t>(std::count(is_exact.begin(), is_exact.end(), 1));
  d.outliers = report_outliers(d.signed_mm);
  return d;
}

double rms_distance_mm(const ClosestPointTree& tree, const std::vector<Vec3>& position_mcs_mm,
                       const RigidTransform& part_from_mcs) {
  const double sum =
      ordered_sum(position_mcs_mm.size(), kBlock, 0.0, [&](std::size_t begin, std::size_t end) {
        double squares = 0.0;
        const auto positions = std::span(position_mcs_mm).subspan(begin, end - begin);
        for (const ClosestPoint& closest : query_points(tree, positions, part_from_mcs).closest)
          squares += closest.distance_mm * closest.distance_mm;
        return squares;
      });
  return std::sqrt(sum / static_cast<double>(position_mcs_mm.size()));
}

}  // namespace trueblade
