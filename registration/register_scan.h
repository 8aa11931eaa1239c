// Registration of a scan to a part: part_from_mcs such that the transformed points lie on the surface.
//
//   const RegistrationTarget target(part);
//   const RegistrationResult result = register_scan(target, scan, initial_part_from_mcs, preset("default"));
//   if (is_converged(result.termination)) use(result.part_from_mcs, result.covariance);
#pragma once

#include "geometry/scan_points.h"
#include "registration/options.h"
#include "registration/result.h"
#include "registration/target.h"

namespace trueblade {

// Aligns `scan` (MCS, mm) to the part, starting from the preliminary transformation of the machine set-up
// (P12), one view by itself (P13). Uses all cores; the result has the same bits on any number of threads.
// Throws InputError for options that contradict one another, weights or SNR out of range, non-finite points,
// unknown surfaces, a scan that is nowhere near the part, or fewer than three non-collinear points.
RegistrationResult register_scan(const RegistrationTarget& target, const ScanPoints& scan,
                                 const RigidTransform& initial_part_from_mcs,
                                 const RegistrationOptions& options);

}  // namespace trueblade
