#include "hardware/plan_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The raster plane of the view in the part frame: cell (row, column) is looked at along `beam`.
struct ViewRaster {
  Vec3 beam;    // unit, pcs
  Vec3 across;  // direction of increasing column
  Vec3 along;   // direction of increasing row
  double across_start_mm, along_start_mm;
  double outside_mm;  // coordinate along the beam of a plane before the whole part
  std::size_t columns, rows;
};

// Rows are stacked along the rotary axis; when the beam runs along it, along the first machine axis that
// stands well across the beam. 30 degrees is enough for a stable projection, and of three independent axes
// at most one lies closer to the beam.
Vec3 row_direction(const MachineGeometry& geometry, const Vec3& beam_stage) {
  constexpr double kSinEnough = 0.5;
  const std::array<Vec3, 4> candidates{geometry.rotary_axis_direction, geometry.axis_direction[2],
                                       geometry.axis_direction[1], geometry.axis_direction[0]};
  Vec3 best = Vec3::Zero();
  for (const Vec3& candidate : candidates) {
    const Vec3 across_beam = candidate - candidate.dot(beam_stage) * beam_stage;
    if (across_beam.norm() >= kSinEnough) return across_beam.normalized();
    if (across_beam.norm() > best.norm()) best = across_beam;
  }
  return best.normalized();
}

ViewRaster lay_raster(const MachineGeometry& geometry, const FacetModel& model,
                      const RigidTransform& part_from_stage, double spacing_mm) {
  const Vec3 beam_stage = geometry.stage_from_probe_at_zero.rotation * geometry.beam_direction;
  const Vec3 along_stage = row_direction(geometry, beam_stage);
  ViewRaster raster;
  raster.beam = part_from_stage.rotation * beam_stage;
  raster.along = part_from_stage.rotation * along_stage;
  raster.across = part_from_stage.rotation * along_stage.cross(beam_stage);

  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double across_low = kInfinity, across_high = -kInfinity, along_low = kInfinity, along_high = -kInfinity;
  raster.outside_mm = kInfinity;
  for (std::uint32_t node = 0; node < model.node_count(); ++node) {
    const Vec3 p = model.node_mm(node);
    across_low = std::min(across_low, p.dot(raster.across));
    across_high = std::max(across_high, p.dot(raster.across));
    along_low = std::min(along_low, p.dot(raster.along));
    along_high = std::max(along_high, p.dot(raster.along));
    raster.outside_mm = std::min(raster.outside_mm, p.dot(raster.beam));
  }
  raster.outside_mm -= 1.0;  // any distance will do: every ray must start before the part

  constexpr double kMostCells = 1e8;  // 3 GB of hits
  const double columns = std::floor((across_high - across_low) / spacing_mm) + 1.0;
  const double rows = std::floor((along_high - along_low) / spacing_mm) + 1.0;
  if (!(columns * rows <= kMostCells))
    throw InputError(
        fmt::format("spacing_mm is {}: the view would have {:.0f} x {:.0f} cells, must be at "
                    "most {:.0e}",
                    spacing_mm, columns, rows, kMostCells));
  raster.columns = static_cast<std::size_t>(columns);
  raster.rows = static_cast<std::size_t>(rows);
  // Centred on the silhouette: the same margin on both sides.
  raster.across_start_mm = 0.5 * (across_low + across_high - (columns - 1.0) * spacing_mm);
  raster.along_start_mm = 0.5 * (along_low + along_high - (rows - 1.0) * spacing_mm);
  return raster;
}

Ray ray_of_cell(const ViewRaster& raster, double spacing_mm, std::size_t row, std::size_t column) {
  const double u = raster.across_start_mm + spacing_mm * static_cast<double>(column);
  const double v = raster.along_start_mm + spacing_mm * static_cast<double>(row);
  return {u * raster.across + v * raster.along + raster.outside_mm * raster.beam, raster.beam};
}

}  // namespace

std::size_t ScanPlan::point_count() const {
  std::size_t count = 0;
  for (const PlannedLine& line : lines) count += line.path.size();
  return count;
}

void PlanOptions::validate(const Part& part) const {
  if (!(spacing_mm > 0.0 && std::isfinite(spacing_mm)))
    throw InputError(fmt::format("view {}: spacing_mm is {}, must be above 0", view, spacing_mm));
  if (!std::isfinite(theta_rad))
    throw InputError(fmt::format("view {}: theta is {}, must be finite", view, theta_rad));
  if (max_incidence_rad && !(*max_incidence_rad > 0.0 && *max_incidence_rad <= 0.5 * std::numbers::pi))
    throw InputError(fmt::format("view {}: max_incidence is {} deg, must be above 0 and at most 90 deg", view,
                                 *max_incidence_rad / kDegree));
  for (const std::uint32_t surface : surfaces)
    if (surface >= part.surfaces.size())
      throw InputError(fmt::format("view {}: surface {} does not exist, the part has surfaces 0 to {}", view,
                                   surface, part.surfaces.size() - 1));
}

ScanPlan plan_view(const MachineGeometry& geometry, const Lens& lens, const Part& nominal,
                   const RayCaster& nominal_caster, const RigidTransform& part_from_mcs,
                   const PlanOptions& options) {
  geometry.validate();
  lens.validate();
  options.validate(nominal);

  const RigidTransform mcs_from_stage = stage_from_mcs(geometry, options.theta_rad).inverse();
  const ViewRaster raster =
      lay_raster(geometry, nominal.model, part_from_mcs * mcs_from_stage, options.spacing_mm);

  std::vector<char> chosen(nominal.surfaces.size(), options.surfaces.empty());
  for (const std::uint32_t surface : options.surfaces) chosen[surface] = true;
  const double least_cosine = std::cos(options.max_incidence_rad.value_or(lens.max_incidence_rad));

  // Range from the raster plane to the surface per cell; NaN where nothing is to be measured.
  std::vector<double> range_mm(raster.columns * raster.rows, std::numeric_limits<double>::quiet_NaN());
  parallel_for_blocks(range_mm.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      const Ray ray = ray_of_cell(raster, options.spacing_mm, cell / raster.columns, cell % raster.columns);
      const auto hit = nominal_caster.first_hit(ray, 0.0, std::numeric_limits<double>::infinity());
      if (!hit || !chosen[nominal.model.surface_of(hit->facet)]) continue;
      if (-hit->normal.dot(ray.direction) < least_cosine) continue;  // grazing, or the inside of an open part
      range_mm[cell] = hit->range_mm;
    }
  });

  ScanPlan plan;
  plan.view = options.view;
  plan.theta_rad = options.theta_rad;
  plan.columns = raster.columns;
  plan.rows = raster.rows;
  const RigidTransform mcs_from_part = part_from_mcs.inverse();
  for (std::size_t row = 0; row < raster.rows; ++row) {
    PlannedLine line;
    const bool forward = plan.lines.size() % 2 == 0;
    for (std::size_t step = 0; step < raster.columns; ++step) {
      const std::size_t column = forward ? step : raster.columns - 1 - step;
      const std::size_t cell = row * raster.columns + column;
      if (std::isnan(range_mm[cell])) continue;
      const Ray ray = ray_of_cell(raster, options.spacing_mm, row, column);
      const Vec3 probe_origin_pcs = ray.origin_mm + (range_mm[cell] - lens.standoff_mm) * ray.direction;
      line.path.push_back(
          axes_for_probe_origin(geometry, mcs_from_part * probe_origin_pcs, options.theta_rad));
      plan.grid_index.push_back(static_cast<std::uint32_t>(cell));
    }
    if (!line.path.empty()) plan.lines.push_back(std::move(line));
  }
  if (plan.lines.empty())
    throw InputError(fmt::format(
        "view {}: no chosen surface is visible at theta {:.3f} deg within {:.1f} deg of incidence",
        options.view, options.theta_rad / kDegree,
        options.max_incidence_rad.value_or(lens.max_incidence_rad) / kDegree));
  return plan;
}

}  // namespace trueblade
