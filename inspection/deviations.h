// Signed deviations of a registered scan from the nominal part: positive outside the material. Part frame
// (PCS), mm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/closest_point_tree.h"
#include "geometry/pseudo_normals.h"
#include "geometry/rigid_transform.h"
#include "geometry/scan_points.h"
#include "inspection/statistics.h"
#include "part/part.h"

namespace trueblade {

enum class DeviationSurface {
  facets,  // the facet model, as the paper does
  exact    // the CAD surface itself, where the part has one and the foot point lies on it; else the facets
};
std::string to_string(DeviationSurface surface);
DeviationSurface parse_deviation_surface(const std::string& name);  // throws InputError naming the choices

struct DeviationOptions {
  DeviationSurface surface = DeviationSurface::exact;
};

// One entry per scan point in every vector.
struct Deviations {
  std::vector<Vec3> point_mm;     // measured, PCS
  std::vector<Vec3> nominal_mm;   // the closest nominal point, PCS
  std::vector<Vec3> normal;       // unit outward normal there
  std::vector<double> signed_mm;  // from the surface that was asked for
  std::vector<double> from_facets_mm;
  std::vector<std::uint32_t> facet;
  std::vector<std::uint32_t> surface;  // CAD surface of the nominal point
  std::vector<double> snr;             // as the scan has it, or empty
  std::size_t exact = 0;               // points whose deviation is from an exact surface
  ReportOutliers outliers;

  std::size_t size() const { return point_mm.size(); }
};

// Finds the closest nominal point of every scan point and applies the report's outlier rule. Threads work on
// fixed blocks, every point by itself: the result does not depend on their number. The tree and the normals
// are those of the part's model. Throws InputError for a point or a pose that is not finite.
Deviations evaluate_deviations(const Part& part, const ClosestPointTree& tree, const PseudoNormals& normals,
                               const ScanPoints& scan, const RigidTransform& part_from_mcs,
                               const DeviationOptions& options);

// Root mean square distance of all scan points from the facets at a pose; of no point, NaN.
double rms_distance_mm(const ClosestPointTree& tree, const std::vector<Vec3>& position_mcs_mm,
                       const RigidTransform& part_from_mcs);

}  // namespace trueblade
