#include "inspection/deviations.h"

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/parallel.h"

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
                               const DeviationOptions&) {
  check_finite(scan, part_from_mcs);
  const std::size_t n = scan.size();
  Deviations d;
  d.point_mm.resize(n);
  d.nominal_mm.resize(n);
  d.normal.resize(n);
  d.signed_mm.resize(n);
  d.from_facets_mm.resize(n);
  d.facet.resize(n);
  d.surface.resize(n);
  d.snr = scan.snr;

  parallel_for_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 point = part_from_mcs * scan.position_mcs_mm[i];
      const ClosestPoint closest = tree.query(point, i > begin ? d.facet[i - 1] : kNoFacet);
      d.point_mm[i] = point;
      d.nominal_mm[i] = closest.point_mm;
      d.normal[i] = normals.normal(closest);
      d.from_facets_mm[i] = normals.signed_distance_mm(closest, point);
      d.signed_mm[i] = d.from_facets_mm[i];
      d.facet[i] = closest.facet;
      d.surface[i] = part.model.surface_of(closest.facet);
    }
  });
  d.outliers = report_outliers(d.signed_mm);
  return d;
}

}  // namespace trueblade
