#include "hardware/plan_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "hardware/check_clearance.h"
#include "hardware/coverage.h"

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

// What one raster cell holds.
struct Cell {
  PointAccess access = PointAccess::facing_away;
  bool chosen = false;  // the beam meets a chosen surface; then:
  Vec3 probe_origin_pcs;
  PlannedPoint point{};
};

std::vector<Cell> look_at_cells(const ViewRaster& raster, const Lens& lens, const Part& nominal,
                                const RayCaster& caster, const AccessCheck& access,
                                const PlanOptions& options) {
  std::vector<char> chosen(nominal.surfaces.size(), options.surfaces.empty());
  for (const std::uint32_t surface : options.surfaces) chosen[surface] = true;

  std::vector<Cell> cells(raster.columns * raster.rows);
  const auto range_of_row = [&](std::size_t row) {
    const double third = static_cast<double>(row % 3) - 1.0;
    return lens.standoff_mm + third * options.standoff_spread_mm;
  };
  parallel_for_blocks(cells.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Ray ray = ray_of_cell(raster, options.spacing_mm, i / raster.columns, i % raster.columns);
      const auto hit = caster.first_hit(ray, 0.0, std::numeric_limits<double>::infinity());
      if (!hit) continue;
      const std::uint32_t surface = nominal.model.surface_of(hit->facet);
      if (!chosen[surface]) continue;
      const Vec3 point = ray.origin_mm + hit->range_mm * ray.direction;
      const double range_mm = range_of_row(i / raster.columns);
      cells[i] = {access.check(point, hit->normal, ray.direction), true, point - range_mm * ray.direction,
                  PlannedPoint{surface, range_mm, -hit->normal.dot(ray.direction)}};
    }
  });
  return cells;
}

// A run of measurable cells of one row that the probe can follow without withdrawing.
struct Run {
  std::vector<std::uint32_t> cells;
};

std::vector<Run> find_runs(const ViewRaster& raster, const std::vector<Cell>& cells,
                           const ProbeClearance& clearance) {
  std::vector<std::vector<Run>> runs_of_row(raster.rows);
  parallel_for_blocks(raster.rows, 1, [&](std::size_t row, std::size_t) {
    std::vector<Run>& runs = runs_of_row[row];
    for (std::size_t column = 0; column < raster.columns; ++column) {
      const auto i = static_cast<std::uint32_t>(row * raster.columns + column);
      if (cells[i].access != PointAccess::measurable) continue;
      const bool goes_on =
          !runs.empty() && clearance.way_is_free(cells[runs.back().cells.back()].probe_origin_pcs,
                                                 cells[i].probe_origin_pcs, raster.beam);
      if (!goes_on) runs.emplace_back();
      runs.back().cells.push_back(i);
    }
  });
  std::vector<Run> runs;
  for (std::vector<Run>& of_row : runs_of_row)
    for (Run& run : of_row) runs.push_back(std::move(run));
  return runs;
}

// Nearest end first, each run in the direction that its nearer end gives. On a full raster this is the
// boustrophedon.
std::vector<Run> order_by_travel(std::vector<Run> runs, const std::vector<Cell>& cells) {
  std::vector<Run> ordered;
  ordered.reserve(runs.size());
  std::vector<char> done(runs.size(), false);
  Vec3 at = runs.empty() ? Vec3::Zero() : cells[runs.front().cells.front()].probe_origin_pcs;
  while (ordered.size() < runs.size()) {
    std::size_t nearest = 0;
    bool reversed = false;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (done[i]) continue;
      const double to_front = (cells[runs[i].cells.front()].probe_origin_pcs - at).squaredNorm();
      const double to_back = (cells[runs[i].cells.back()].probe_origin_pcs - at).squaredNorm();
      if (std::min(to_front, to_back) < least) {
        least = std::min(to_front, to_back);
        nearest = i;
        reversed = to_back < to_front;
      }
    }
    done[nearest] = true;
    ordered.push_back(std::move(runs[nearest]));
    if (reversed) std::reverse(ordered.back().cells.begin(), ordered.back().cells.end());
    at = cells[ordered.back().cells.back()].probe_origin_pcs;
  }
  return ordered;
}

std::string count_reasons(const std::array<std::size_t, kPointAccessCount>& cells) {
  std::string reasons;
  for (std::size_t k = 1; k < kPointAccessCount; ++k)
    if (cells[k] > 0)
      reasons += fmt::format("{}{} {}", reasons.empty() ? ": " : ", ", cells[k],
                             to_string(static_cast<PointAccess>(k)));
  return reasons;
}

// No beam of the raster meets a chosen surface: they are out of sight, or they slip through the raster.
std::string why_nothing_is_met(const MachineGeometry& geometry, const Part& nominal,
                               const RigidTransform& part_from_mcs, const AccessCheck& access,
                               const ViewRaster& raster, const PlanOptions& options) {
  constexpr std::size_t kSamples = 1000;
  const std::vector<SurfaceSample> samples = sample_surfaces(nominal, options.surfaces, kSamples);
  const std::vector<PointAccess> seen =
      access_from_angle(geometry, part_from_mcs, options.theta_rad, access, samples);
  const auto measurable = std::find(seen.begin(), seen.end(), PointAccess::measurable);
  if (measurable == seen.end()) {
    std::array<std::size_t, kPointAccessCount> count{};
    for (const PointAccess of_sample : seen) ++count[static_cast<std::size_t>(of_sample)];
    return fmt::format(
        "view {}: nothing of the chosen surfaces can be measured at theta {:.3f} deg; of {} places spread "
        "over "
        "them{}",
        options.view, options.theta_rad / kDegree, samples.size(), count_reasons(count));
  }
  const std::uint32_t surface = samples[static_cast<std::size_t>(measurable - seen.begin())].surface;
  double across_low = std::numeric_limits<double>::infinity(), across_high = -across_low;
  double along_low = across_low, along_high = across_high;
  for (std::uint32_t facet = 0; facet < nominal.model.facet_count(); ++facet) {
    if (nominal.model.surface_of(facet) != surface) continue;
    for (const Vec3& corner : nominal.model.corners_mm(facet)) {
      across_low = std::min(across_low, corner.dot(raster.across));
      across_high = std::max(across_high, corner.dot(raster.across));
      along_low = std::min(along_low, corner.dot(raster.along));
      along_high = std::max(along_high, corner.dot(raster.along));
    }
  }
  return fmt::format(
      "view {}: spacing_mm is {}, too coarse for the chosen surfaces: surface {} ({}) can be seen at theta "
      "{:.3f} "
      "deg, but no position of the raster falls on what is seen of it; it measures {:.3g} x {:.3g} mm across "
      "the "
      "beam",
      options.view, options.spacing_mm, surface, nominal.surfaces[surface].name, options.theta_rad / kDegree,
      across_high - across_low, along_high - along_low);
}

}  // namespace

void PlanOptions::validate(const Part& part, const Lens& lens) const {
  if (!(spacing_mm > 0.0 && std::isfinite(spacing_mm)))
    throw InputError(fmt::format("view {}: spacing_mm is {}, must be above 0", view, spacing_mm));
  if (!(standoff_spread_mm >= 0.0 && standoff_spread_mm < 0.5 * lens.working_range_mm))
    throw InputError(fmt::format(
        "view {}: standoff_spread_mm is {}, must be at least 0 and below {}, half the working range", view,
        standoff_spread_mm, 0.5 * lens.working_range_mm));
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
  options.validate(nominal, lens);
  const double max_incidence_rad = options.max_incidence_rad.value_or(lens.max_incidence_rad);
  const ProbeClearance clearance(nominal.model, options.probe);
  const AccessCheck access(nominal_caster, clearance, lens, options.probe, max_incidence_rad);

  const RigidTransform part_from_stage =
      part_from_mcs * stage_from_mcs(geometry, options.theta_rad).inverse();
  const ViewRaster raster = lay_raster(geometry, nominal.model, part_from_stage, options.spacing_mm);
  const std::vector<Cell> cells = look_at_cells(raster, lens, nominal, nominal_caster, access, options);
  const std::vector<Run> runs = order_by_travel(find_runs(raster, cells, clearance), cells);

  ScanPlan plan;
  plan.view = options.view;
  plan.theta_rad = options.theta_rad;
  plan.columns = raster.columns;
  plan.rows = raster.rows;
  for (const Cell& cell : cells)
    if (cell.chosen) ++plan.cells[static_cast<std::size_t>(cell.access)];
  if (std::none_of(cells.begin(), cells.end(), [](const Cell& cell) { return cell.chosen; }))
    throw NothingToMeasure(why_nothing_is_met(geometry, nominal, part_from_mcs, access, raster, options));
  if (runs.empty())
    throw NothingToMeasure(fmt::format(
        "view {}: nothing of the chosen surfaces can be measured at theta {:.3f} deg "
        "within {:.1f} deg of incidence{}",
        options.view, options.theta_rad / kDegree, max_incidence_rad / kDegree, count_reasons(plan.cells)));

  const RigidTransform mcs_from_part = part_from_mcs.inverse();
  const auto axes_at = [&](const Vec3& probe_origin_pcs) {
    return axes_for_probe_origin(geometry, mcs_from_part * probe_origin_pcs, options.theta_rad);
  };
  // Withdrawn along the beam to a plane (a coordinate along it) before the part.
  const auto withdrawn = [&](const Vec3& origin_pcs, double along_beam_mm) -> Vec3 {
    return origin_pcs + std::min(0.0, along_beam_mm - origin_pcs.dot(raster.beam)) * raster.beam;
  };
  const double hop_plane_mm = raster.outside_mm - options.probe.clearance_mm;
  // The turning limit is a coordinate in the stage: move it to the part's origin.
  const double turning_plane_mm =
      turning_limit_mm(geometry, nominal.model, mcs_from_part, options.probe.clearance_mm) +
      part_from_stage.translation_mm.dot(raster.beam);

  std::optional<Vec3> at;
  for (const Run& run : runs) {
    PlannedLine line;
    const Vec3& start = cells[run.cells.front()].probe_origin_pcs;
    if (!at) {
      line.approach.push_back(axes_at(withdrawn(start, turning_plane_mm)));
    } else if (!clearance.way_is_free(*at, start, raster.beam)) {
      line.approach.push_back(axes_at(withdrawn(*at, hop_plane_mm)));
      line.approach.push_back(axes_at(withdrawn(start, hop_plane_mm)));
    }
    for (const std::uint32_t cell : run.cells) {
      line.path.push_back(axes_at(cells[cell].probe_origin_pcs));
      plan.grid_index.push_back(cell);
      plan.points.push_back(cells[cell].point);
    }
    at = cells[run.cells.back()].probe_origin_pcs;
    plan.lines.push_back(std::move(line));
  }
  plan.retreat.push_back(axes_at(withdrawn(*at, turning_plane_mm)));
  return plan;
}

}  // namespace trueblade
