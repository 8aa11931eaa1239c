#include "hardware/coverage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr std::size_t kLeastPerSurface = 16;

double fraction(double x) {
  return x - std::floor(x);
}

// The access that came nearest to measuring the point. PointAccess lists the reasons in the order in which
// they are tested, so that a later one means that more was passed; measurable is best.
PointAccess better(PointAccess a, PointAccess b) {
  if (a == PointAccess::measurable || b == PointAccess::measurable) return PointAccess::measurable;
  return std::max(a, b);
}

}  // namespace

std::vector<SurfaceSample> sample_surfaces(const Part& part, std::span<const std::uint32_t> surfaces,
                                           std::size_t count) {
  std::vector<char> chosen(part.surfaces.size(), surfaces.empty());
  for (const std::uint32_t surface : surfaces) chosen[surface] = true;

  const FacetModel& model = part.model;
  std::vector<std::vector<std::uint32_t>> facets_of(part.surfaces.size());
  std::vector<double> facet_area(model.facet_count());
  double area = 0.0;
  for (std::uint32_t f = 0; f < model.facet_count(); ++f) {
    if (!chosen[model.surface_of(f)]) continue;
    const auto c = model.corners_mm(f);
    facet_area[f] = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
    area += facet_area[f];
    facets_of[model.surface_of(f)].push_back(f);
  }

  std::vector<SurfaceSample> samples;
  for (std::uint32_t surface = 0; surface < facets_of.size(); ++surface) {
    double surface_area = 0.0;
    for (const std::uint32_t f : facets_of[surface]) surface_area += facet_area[f];
    if (surface_area == 0.0) continue;
    const double share = static_cast<double>(count) * surface_area / area;
    const auto n = std::max(kLeastPerSurface, static_cast<std::size_t>(std::lround(share)));
    // One sample in the middle of each n-th of the area, facets laid end to end; its place across the facet
    // from the golden-ratio sequence.
    const double step = surface_area / static_cast<double>(n);
    std::size_t next = 0;
    double area_before = 0.0;
    for (const std::uint32_t f : facets_of[surface]) {
      for (; next < n && (static_cast<double>(next) + 0.5) * step < area_before + facet_area[f]; ++next) {
        const double along = ((static_cast<double>(next) + 0.5) * step - area_before) / facet_area[f];
        const double across = fraction(0.6180339887498949 * static_cast<double>(next));
        // The unit square onto the triangle, area-true (Turk 1990).
        const double root = std::sqrt(along);
        const auto c = model.corners_mm(f);
        const Vec3 point = (1.0 - root) * c[0] + root * (1.0 - across) * c[1] + root * across * c[2];
        samples.push_back({point, model.facet_normal(f), surface, step});
      }
      area_before += facet_area[f];
    }
  }
  return samples;
}

std::vector<PointAccess> access_from_angle(const MachineGeometry& geometry,
                                           const RigidTransform& part_from_mcs, double theta_rad,
                                           const AccessCheck& access,
                                           std::span<const SurfaceSample> samples) {
  const Vec3 beam = part_from_mcs.rotation * beam_in_mcs(geometry, {0.0, 0.0, 0.0, theta_rad}).direction;
  std::vector<PointAccess> result(samples.size());
  parallel_for_blocks(samples.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      result[i] = access.check(samples[i].point_mm, samples[i].normal, beam);
  });
  return result;
}

Coverage summarise_coverage(std::span<const double> theta_rad, std::span<const SurfaceSample> samples,
                            std::span<const std::vector<PointAccess>> access) {
  Coverage coverage;
  coverage.theta_rad.assign(theta_rad.begin(), theta_rad.end());
  coverage.samples.assign(samples.begin(), samples.end());
  coverage.access.assign(access.begin(), access.end());
  double area = 0.0, seen_area = 0.0;
  // Samples come surface by surface.
  for (std::size_t begin = 0; begin < samples.size();) {
    SurfaceCoverage of_surface{
        samples[begin].surface, 0.0, std::vector<double>(theta_rad.size(), 0.0), 0.0, {}};
    std::size_t i = begin;
    for (; i < samples.size() && samples[i].surface == of_surface.surface; ++i) {
      PointAccess best = PointAccess::facing_away;
      for (std::size_t view = 0; view < access.size(); ++view) {
        best = better(best, access[view][i]);
        if (access[view][i] == PointAccess::measurable)
          of_surface.seen_from_view[view] += samples[i].area_mm2;
      }
      of_surface.area_mm2 += samples[i].area_mm2;
      of_surface.by_access[static_cast<std::size_t>(best)] += samples[i].area_mm2;
    }
    begin = i;
    area += of_surface.area_mm2;
    seen_area += of_surface.by_access[0];
    for (double& share : of_surface.seen_from_view) share /= of_surface.area_mm2;
    for (double& share : of_surface.by_access) share /= of_surface.area_mm2;
    of_surface.seen = of_surface.by_access[0];
    coverage.surfaces.push_back(std::move(of_surface));
  }
  coverage.seen = area > 0.0 ? seen_area / area : 0.0;
  return coverage;
}

}  // namespace trueblade
