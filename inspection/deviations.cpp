#include "inspection/deviations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "part/exact_closest_point.h"

namespace trueblade {
namespace {

// A query costs about a microsecond, starting a task about as much: 256 of them hide the start.
constexpr std::size_t kBlock = 256;

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
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 point = part_from_mcs * scan.position_mcs_mm[i];
      const ClosestPoint closest = tree.query(point, i > begin ? d.facet[i - 1] : kNoFacet);
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
        std::uint32_t facet = kNoFacet;
        for (std::size_t i = begin; i < end; ++i) {
          const ClosestPoint closest = tree.query(part_from_mcs * position_mcs_mm[i], facet);
          facet = closest.facet;
          squares += closest.distance_mm * closest.distance_mm;
        }
        return squares;
      });
  return std::sqrt(sum / static_cast<double>(position_mcs_mm.size()));
}

}  // namespace trueblade
