// Which tolerance holds where along the outline of a section: that of the profile that covers the surface
// there.
#pragma once

#include <string>
#include <vector>

#include "inspection/measure_section.h"
#include "inspection/profile.h"
#include "registration/target.h"

namespace trueblade {

// Points `first` to `last` of the outline, both included, lie on surfaces of the profile.
struct ProfileStretch {
  std::string profile;
  std::size_t first = 0, last = 0;
};

// The outline lies on the nominal part, so that the closest facet names the surface. Where several profiles
// cover it, the one with the narrowest zone is told; where none does, there is no stretch.
std::vector<ProfileStretch> profile_stretches(const RegistrationTarget& target, const SectionPlane& plane,
                                              const std::vector<Vec2>& outline_mm,
                                              const std::vector<ProfileResult>& profiles);

}  // namespace trueblade
