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

#include "hardware/machine_geometry.h"
#include "sim/machine_errors.h"

namespace trueblade {

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
