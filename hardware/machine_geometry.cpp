#include "hardware/machine_geometry.h"

#include <fmt/core.h>

#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

void require_unit(const char* name, const Vec3& direction) {
  // A direction typed with nine digits is unit to 1e-9; the square deviates by twice that.
  constexpr double kTolerance = 1e-8;
  const double norm = direction.norm();
  if (!(std::abs(norm - 1.0) <= kTolerance))
    throw InputError(fmt::format("{} has length {}, must be a unit vector", name, norm));
}

}  // namespace

void MachineGeometry::validate() const {
  require_unit("axis_direction x", axis_direction[0]);
  require_unit("axis_direction y", axis_direction[1]);
  require_unit("axis_direction z", axis_direction[2]);
  require_unit("beam_direction", beam_direction);
  require_unit("rotary_axis_direction", rotary_axis_direction);
  if (!rotary_axis_point_mm.allFinite()) throw InputError("rotary_axis_point_mm must be finite");
  if (!is_finite(stage_from_probe_at_zero)) throw InputError("stage_from_probe_at_zero must be finite");
  // Three stages that nearly lie in one plane cannot reach a volume: below 0.1 two of them are within 6
  // degrees of each other, or the third within 6 degrees of the plane of the others.
  const double volume = std::abs(axis_directions(*this).determinant());
  if (!(volume > 0.1))
    throw InputError(fmt::format(
        "axis_direction: x, y and z span a volume of {:.3g}, must be above 0.1 (independent axes)", volume));
  const bool each_once = linear_axis_order[0] != linear_axis_order[1] &&
                         linear_axis_order[1] != linear_axis_order[2] &&
                         linear_axis_order[0] != linear_axis_order[2];
  if (!each_once) throw InputError("linear_axis_order must name x, y and z once each");
}

Mat3 axis_directions(const MachineGeometry& geometry) {
  Mat3 directions;
  for (int k = 0; k < 3; ++k) directions.col(k) = geometry.axis_direction[static_cast<std::size_t>(k)];
  return directions;
}

Eigen::Matrix<double, 3, 2> beam_normals(const MachineGeometry& geometry) {
  const Vec3& beam = geometry.beam_direction;
  Eigen::Matrix<double, 3, 2> normals;
  normals.col(0) = beam.unitOrthogonal();
  normals.col(1) = beam.cross(normals.col(0));
  return normals;
}

Mat3 rotary_axis_normals(const MachineGeometry& geometry) {
  const Vec3 z = geometry.rotary_axis_direction;
  // Independent axes cannot both lie along z; the one farther from it projects well.
  const bool x_usable = geometry.axis_direction[0].cross(z).norm() > 0.5;
  const Vec3 reference = geometry.axis_direction[x_usable ? 0 : 1];
  Mat3 normals;
  normals.col(0) = (reference - reference.dot(z) * z).normalized();
  normals.col(1) = z.cross(normals.col(0));
  normals.col(2) = z;
  return normals;
}

RigidTransform stage_from_probe(const MachineGeometry& geometry, const AxisPositions& axes) {
  RigidTransform result = geometry.stage_from_probe_at_zero;
  result.translation_mm += geometry.axis_direction[0] * axes.x_mm + geometry.axis_direction[1] * axes.y_mm +
                           geometry.axis_direction[2] * axes.z_mm;
  return result;
}

RigidTransform stage_from_mcs(const MachineGeometry& geometry, double theta_rad) {
  RigidTransform result;
  result.rotation = Eigen::AngleAxisd(theta_rad, geometry.rotary_axis_direction);
  result.translation_mm = geometry.rotary_axis_point_mm - result.rotation * geometry.rotary_axis_point_mm;
  return result;
}

Ray beam_in_mcs(const MachineGeometry& geometry, const AxisPositions& axes) {
  const RigidTransform mcs_from_stage = stage_from_mcs(geometry, axes.theta_rad).inverse();
  const RigidTransform mcs_from_probe = mcs_from_stage * stage_from_probe(geometry, axes);
  return {mcs_from_probe.translation_mm, mcs_from_probe.rotation * geometry.beam_direction};
}

Vec3 point_in_mcs_mm(const MachineGeometry& geometry, const ProbeSample& sample) {
  const Ray beam = beam_in_mcs(geometry, sample.axes);
  return beam.origin_mm + sample.distance_mm * beam.direction;
}

AxisPositions axes_for_probe_origin(const MachineGeometry& geometry, const Vec3& probe_origin_mcs_mm,
                                    double theta_rad) {
  const Vec3 origin_stage = stage_from_mcs(geometry, theta_rad) * probe_origin_mcs_mm;
  const Vec3 travel = axis_directions(geometry).partialPivLu().solve(
      origin_stage - geometry.stage_from_probe_at_zero.translation_mm);
  return {travel.x(), travel.y(), travel.z(), theta_rad};
}

}  // namespace trueblade
