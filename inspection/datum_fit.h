// Registration as an inspection plan asks for it: best fit first, then, where datum surfaces are named, onto
// these alone.
#pragma once

#include <cstdint>
#include <vector>

#include "registration/register_scan.h"

namespace trueblade {

// Without datum surfaces this is register_scan. With them, the best fit is the start of a second fit to the
// datum surfaces only. What they do not determine stays as in the best fit and is named in `undetermined`.
// first_rms_mm is that of the set-up, iterations and work count both fits. Throws as register_scan does.
RegistrationResult register_to_datum(const RegistrationTarget& target, const ScanPoints& scan,
                                     const RigidTransform& initial_part_from_mcs,
                                     const RegistrationOptions& options,
                                     const std::vector<std::uint32_t>& datum_surfaces);

}  // namespace trueblade
