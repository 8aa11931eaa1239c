// The true machine: the kinematic chain of machine_geometry.h with one draw of the errors in it. Only the
// simulation knows it; the program converts samples with the nominal chain, and the difference is the
// experiment.
//
//   stage_from_probe = product over the linear axes, in the order in which they carry each other, of
//                      shift(travel along the true axis direction) * error motion of the axis,
//                      then the mount with the probe's own errors
//   stage_from_mcs   = shift(P) L E R(theta + ECC) inverse(L) shift(-P): R the nominal rotation, E the error
//                      motion of the axis (EXC ... EBC), L its direction (AOC, BOC), P its place (XOC, YOC)
//   mcs_from_part    = mcs_from_fixture * fixture on table * part in fixture * inverse(mcs_from_fixture) *
//                      nominal mcs_from_part
//
// Error motions of the linear axes act along and about the axis directions of the machine, with the reference
// point of each axis at the stage origin carried along by the axes below it (rigid-body model): an angular
// error acts on the probe with the lever arm from there. Those of the rotary axis act in a frame at the
// rotary axis with z along it and x as near to the machine's x axis as that allows. Rotations are given by
// their rotation vector.
#pragma once

#include <array>

#include "hardware/machine_geometry.h"
#include "sim/machine_errors.h"

namespace trueblade {

// The true stage_from_probe while the errors stand still: one orientation, and an origin that is linear in
// travel, in time and in those errors that shift the probe.
struct TrueProbeChain {
  Eigen::Quaterniond rotation;
  Vec3 origin_at_zero_mm;       // x = y = z = 0, time 0
  Mat3 origin_per_travel;       // columns: per mm of x, y, z
  Vec3 origin_per_s_mm;         // thermal drift
  Mat3 origin_per_probe_shift;  // columns: per mm of probe_x, probe_y, probe_z
  // By axis, columns: per mm of its positioning and straightness errors along x, y, z.
  std::array<Mat3, 3> origin_per_axis_shift;
};
TrueProbeChain true_probe_chain(const MachineGeometry& nominal, const ErrorValues& errors);
// What 1 mm more of `source` adds to the origin: 0 for sources that are no shift of the probe.
Vec3 origin_per_value(const TrueProbeChain& chain, ErrorSource source);
bool is_shift_of_probe(ErrorSource source);

// `drift_time_s`: how long the thermal drift has gone on.
RigidTransform true_stage_from_probe(const MachineGeometry& nominal, const AxisPositions& axes,
                                     const ErrorValues& errors, double drift_time_s);

RigidTransform true_stage_from_mcs(const MachineGeometry& nominal, double theta_rad,
                                   const ErrorValues& errors);

RigidTransform true_mcs_from_part(const RigidTransform& nominal_mcs_from_part,
                                  const RigidTransform& mcs_from_fixture, const ErrorValues& errors);

// What of the errors does not depend on where the machine stands, as a geometry: mount (at x = y = z = 0),
// beam, place and direction of the rotary axis. With no other errors the nominal chain of it is the true
// chain.
MachineGeometry true_geometry(const MachineGeometry& nominal, const ErrorValues& errors);

// The beam in the probe frame, tilted by beam_a and beam_b about two fixed normals of the nominal beam.
Vec3 true_beam_direction(const MachineGeometry& nominal, const ErrorValues& errors);

}  // namespace trueblade
