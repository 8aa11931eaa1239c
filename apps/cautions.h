// What a user must be told beside the numbers of a registration: that it did not converge, that the scan
// leaves a freedom open, that it does not fit the part everywhere, that the cross-check disagrees.
#pragma once

#include <string>
#include <vector>

#include "inspection/result.h"

namespace trueblade {

// One sentence each, beginning with the view; empty when there is nothing to say.
std::vector<std::string> cautions(const ViewResult& view);

// The registration converged, determines something of the pose, and its cross-check, where there is one,
// agrees.
bool is_sound(const RegistrationResult& registration);

}  // namespace trueblade
