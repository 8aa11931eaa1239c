#include "hardware/check_clearance.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "geometry/error.h"

namespace trueblade {
namespace {

std::string words(const AxisPositions& at) {
  return fmt::format("x {:.3f} y {:.3f} z {:.3f} mm theta {:.3f} deg", at.x_mm, at.y_mm, at.z_mm,
                     at.theta_rad * 180.0 / std::numbers::pi);
}

class MoveCheck {
 public:
  MoveCheck(const std::string& view, const MachineGeometry& geometry, const RigidTransform& part_from_mcs,
            const ProbeClearance& clearance, double turning_limit_mm)
      : view_(view),
        geometry_(geometry),
        part_from_mcs_(part_from_mcs),
        clearance_(clearance),
        turning_limit_mm_(turning_limit_mm) {}

  void move(const AxisPositions& from, const AxisPositions& to, const std::string& what) const {
    if (before_turning_limit(from) && before_turning_limit(to)) return;
    if (from.theta_rad != to.theta_rad)
      throw InputError(fmt::format(
          "view {}: {}, from {} to {}: the table would turn while the probe stands in the way of the part",
          view_, what, words(from), words(to)));
    const Ray from_beam = beam_in_part(from), to_beam = beam_in_part(to);
    if (!clearance_.way_is_free(from_beam.origin_mm, to_beam.origin_mm, from_beam.direction))
      throw InputError(fmt::format("view {}: {}, from {} to {}: the probe would touch the part", view_, what,
                                   words(from), words(to)));
  }

 private:
  bool before_turning_limit(const AxisPositions& at) const {
    const RigidTransform probe = stage_from_probe(geometry_, at);
    const Vec3 beam = probe.rotation * geometry_.beam_direction;
    // The limit is planned to, and met to rounding.
    return probe.translation_mm.dot(beam) <= turning_limit_mm_ + ProbeClearance::kResolutionMm;
  }

  Ray beam_in_part(const AxisPositions& at) const {
    const Ray beam = beam_in_mcs(geometry_, at);
    return {part_from_mcs_ * beam.origin_mm, part_from_mcs_.rotation * beam.direction};
  }

  const std::string& view_;
  const MachineGeometry& geometry_;
  const RigidTransform& part_from_mcs_;
  const ProbeClearance& clearance_;
  double turning_limit_mm_;
};

}  // namespace

double turning_limit_mm(const MachineGeometry& geometry, const FacetModel& nominal,
                        const RigidTransform& mcs_from_part, double clearance_mm) {
  const Vec3 beam = geometry.stage_from_probe_at_zero.rotation * geometry.beam_direction;
  const Vec3& axis = geometry.rotary_axis_direction;
  const double across_axis = beam.cross(axis).norm();
  double limit = std::numeric_limits<double>::infinity();
  for (std::uint32_t node = 0; node < nominal.node_count(); ++node) {
    const Vec3 from_axis = mcs_from_part * nominal.node_mm(node) - geometry.rotary_axis_point_mm;
    const Vec3 along_axis = from_axis.dot(axis) * axis;
    const double radius = (from_axis - along_axis).norm();
    limit = std::min(limit, (geometry.rotary_axis_point_mm + along_axis).dot(beam) - radius * across_axis);
  }
  return limit - clearance_mm;
}

void check_clearance(const ScanPlan& plan, const MachineGeometry& geometry, const FacetModel& nominal,
                     const RigidTransform& part_from_mcs, const ProbeClearance& clearance,
                     const ProbeBody& body, const AxisPositions& start) {
  const double limit_mm = turning_limit_mm(geometry, nominal, part_from_mcs.inverse(), body.clearance_mm);
  const MoveCheck check(plan.view, geometry, part_from_mcs, clearance, limit_mm);
  AxisPositions at = start;
  const auto go = [&](const AxisPositions& to, const std::string& what) {
    check.move(at, to, what);
    at = to;
  };
  for (std::size_t number = 0; number < plan.lines.size(); ++number) {
    const PlannedLine& line = plan.lines[number];
    if (line.path.empty()) continue;
    const std::string way = fmt::format("the way to planned line {}", number + 1);
    for (const AxisPositions& to : line.approach) go(to, way);
    go(line.path.front(), way);
    const std::string along = fmt::format("planned line {}", number + 1);
    for (const AxisPositions& to : line.path) go(to, along);
  }
  for (const AxisPositions& to : plan.retreat) go(to, "the retreat");
}

void check_first_way(const std::string& view, const MachineGeometry& geometry, const FacetModel& nominal,
                     const RigidTransform& part_from_mcs, const ProbeClearance& clearance,
                     const ProbeBody& body, const AxisPositions& start, std::span<const AxisPositions> way) {
  const double limit_mm = turning_limit_mm(geometry, nominal, part_from_mcs.inverse(), body.clearance_mm);
  const MoveCheck check(view, geometry, part_from_mcs, clearance, limit_mm);
  AxisPositions at = start;
  for (const AxisPositions& to : way) {
    check.move(at, to, "the way from where the machine stands");
    at = to;
  }
}

}  // namespace trueblade
