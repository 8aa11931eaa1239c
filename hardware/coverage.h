// Coverage: how much of each CAD surface is seen from which rotary angle, and where not and why. It is
// estimated on sample points spread over the surfaces by area.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/ray_caster.h"
#include "hardware/machine_geometry.h"
#include "hardware/point_access.h"
#include "part/part.h"

namespace trueblade {

struct SurfaceSample {
  Vec3 point_mm;  // PCS
  Vec3 normal;    // unit, outward
  std::uint32_t surface;
  double area_mm2;  // that it stands for
};

// About `count` samples, in proportion to area but at least 16 on each surface (so that a share is known to
// an eighth, one standard error), at the golden-ratio sequence over the facets. The same samples for the same
// part. `surfaces`: the chosen ones; empty: all.
std::vector<SurfaceSample> sample_surfaces(const Part& part, std::span<const std::uint32_t> surfaces,
                                           std::size_t count);

// The access of every sample from one rotary angle, in the order of the samples.
std::vector<PointAccess> access_from_angle(const MachineGeometry& geometry,
                                           const RigidTransform& part_from_mcs, double theta_rad,
                                           const AccessCheck& access, std::span<const SurfaceSample> samples);

struct SurfaceCoverage {
  std::uint32_t surface;
  double area_mm2;
  std::vector<double> seen_from_view;  // share of the area, one per view
  double seen;                         // share of the area seen from any view
  // What stands in the way of the rest: share of the area by reason, each sample by the reason of the view
  // that came nearest to measuring it (the highest in the order of PointAccess). The entry of `measurable` is
  // `seen`.
  std::array<double, kPointAccessCount> by_access;
};

struct Coverage {
  std::vector<double> theta_rad;  // the views
  std::vector<SurfaceCoverage> surfaces;
  double seen;  // share of the whole area of the chosen surfaces
  // What it was found from: the samples, and the access of every sample from every view.
  std::vector<SurfaceSample> samples;
  std::vector<std::vector<PointAccess>> access;
};

// `access[v][i]`: of sample i from view v.
Coverage summarise_coverage(std::span<const double> theta_rad, std::span<const SurfaceSample> samples,
                            std::span<const std::vector<PointAccess>> access);

}  // namespace trueblade
