// Registration of a scan to a part: part_from_mcs such that the transformed points lie on the surface.
#pragma once

#include "geometry/pseudo_normals.h"
#include "geometry/scan_points.h"
#include "part/part.h"
#include "registration/options.h"
#include "registration/result.h"

namespace trueblade {

// The search structures over a part, built once and shared by any number of registrations and threads.
// Keeps a reference: the part must outlive it.
class RegistrationTarget;

// Aligns `scan` (MCS, mm) to the part, starting from the preliminary transformation of the machine set-up
// (P12). Throws InputError for options that contradict one another, weights or SNR out of range, non-finite
// points, unknown surfaces, or fewer than three non-collinear points.
RegistrationResult register_scan(const RegistrationTarget& target, const ScanPoints& scan,
                                 const RigidTransform& initial_part_from_mcs,
                                 const RegistrationOptions& options);

}  // namespace trueblade
