#include "apps/cautions.h"

#include <fmt/format.h>

namespace trueblade {

std::vector<std::string> cautions(const ViewResult& view) {
  const RegistrationResult& registration = view.registration;
  std::vector<std::string> found;
  if (!view.failure.empty()) return {fmt::format("view {}: {}", view.view, view.failure)};
  if (!is_converged(registration.termination))
    found.push_back(fmt::format("view {}: the registration did not converge ({}): its pose is no result",
                                view.view, to_string(registration.termination)));
  for (const UndeterminedDirection& direction : registration.undetermined)
    found.push_back(fmt::format("view {}: the scan does not determine {}; it stays as in the initial pose",
                                view.view, direction.words));
  if (registration.shows_misfit)
    found.push_back(fmt::format(
        "view {}: neighbouring residuals agree: the scan does not fit the part everywhere. Either the "
        "part has form errors of the size of the RMS, or it is another part, or it stood (or the scan "
        "lay) too far from where the initial pose says",
        view.view));
  if (registration.cross_check && !registration.cross_check->agrees)
    found.push_back(
        fmt::format("view {}: the cross-check disagrees: {}", view.view, registration.cross_check->summary));
  return found;
}

bool is_sound(const RegistrationResult& registration) {
  const auto& cross_check = registration.cross_check;
  return is_converged(registration.termination) && registration.undetermined.size() < 6 &&
         (!cross_check || cross_check->agrees);
}

}  // namespace trueblade
