// Kinematics of the four-axis machine (paper, Fig. 4), the same for every backend.
//
//   mcs --(rotary axis, theta)--> stage <--(x, y, z axes)-- probe
//
//   stage  the machine base. The linear axes move the probe in it; the rotary axis stands in it.
//   probe  the conoscopic sensor: its origin is the point from which distances count, its beam leaves along
//          `beam_direction`.
//   mcs    the measurement coordinate system turns with the rotary table and equals `stage` at theta = 0, so
//          that one preliminary part_from_mcs serves all views, and views can be compared.
#pragma once

#include <array>

#include "geometry/ray_caster.h"
#include "geometry/rigid_transform.h"
#include "hardware/machine_driver.h"

namespace trueblade {

enum class LinearAxis : std::uint8_t { x, y, z };

struct MachineGeometry {
  // Which stage carries which, from the machine base to the probe. The nominal chain does not depend on it
  // (translations commute); the angular errors of a stage act on what it carries.
  std::array<LinearAxis, 3> linear_axis_order{LinearAxis::x, LinearAxis::y, LinearAxis::z};
  // Directions in which the probe moves when x, y, z increase; unit vectors in `stage`.
  std::array<Vec3, 3> axis_direction{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  // The probe frame in `stage` with x = y = z = 0 (mount).
  RigidTransform stage_from_probe_at_zero;
  // Beam in the probe frame, unit. Default: the probe looks along -y of the stage.
  Vec3 beam_direction = -Vec3::UnitY();
  // The rotary axis in `stage`: the part turns by +theta about this direction (right-hand rule).
  Vec3 rotary_axis_point_mm = Vec3::Zero();
  Vec3 rotary_axis_direction = Vec3::UnitZ();

  // Throws InputError: unit directions, independent axes, every linear axis once in the order.
  void validate() const;
};

// x, y and z direction of the linear axes in `stage`, as columns.
Mat3 axis_directions(const MachineGeometry& geometry);
// The two normals of the beam about which it is tilted, in the probe frame.
Eigen::Matrix<double, 3, 2> beam_normals(const MachineGeometry& geometry);
// The two normals of the rotary axis along and about which it is shifted and tilted, in `stage`: the first as
// near to the machine's x axis as possible (its y axis, when x is along the rotary axis). Columns: first,
// second, axis.
Mat3 rotary_axis_normals(const MachineGeometry& geometry);

// The probe frame in `stage` at the given axes.
RigidTransform stage_from_probe(const MachineGeometry& geometry, const AxisPositions& axes);
// The turned table in `stage`: stage_from_mcs at the rotary angle.
RigidTransform stage_from_mcs(const MachineGeometry& geometry, double theta_rad);
// The beam in the MCS: from the probe origin along the beam.
Ray beam_in_mcs(const MachineGeometry& geometry, const AxisPositions& axes);
// A usable sample as a point in the MCS (mm).
Vec3 point_in_mcs_mm(const MachineGeometry& geometry, const ProbeSample& sample);

// The axis positions that put the probe origin at `probe_origin_mcs_mm` (a point of the MCS) at the rotary
// angle.
AxisPositions axes_for_probe_origin(const MachineGeometry& geometry, const Vec3& probe_origin_mcs_mm,
                                    double theta_rad);

}  // namespace trueblade
