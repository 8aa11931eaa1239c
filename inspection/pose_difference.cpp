#include "inspection/pose_difference.h"

#include <cmath>

#include "registration/covariance.h"

namespace trueblade {
namespace {

Mat6 covariance_about(const RegistrationResult& fit, const Vec3& pivot_mm) {
  return covariance_about_pivot(fit.covariance, fit.centroid_part_mm, pivot_mm);
}

// A tenth of a unit direction: a component that moves less along it hardly depends on it.
constexpr double kShare = 0.1;

void mark_undetermined(const RegistrationResult& fit, std::array<bool, 6>& determined) {
  for (const UndeterminedDirection& open : fit.undetermined) {
    const bool turns = open.direction.head<3>().norm() > kShare;
    for (std::size_t k = 0; k < 6; ++k) {
      // An open rotation moves the pivot too, by an arm that is not known here: all translations are open.
      const bool moves = std::abs(open.direction[static_cast<Eigen::Index>(k)]) > kShare;
      if (moves || (k >= 3 && turns)) determined[k] = false;
    }
  }
}

}  // namespace

PoseDifference pose_difference(const std::string& of, const RegistrationResult& fit_of,
                               const std::string& from, const RegistrationResult& fit_from) {
  PoseDifference difference;
  difference.of = of;
  difference.from = from;
  difference.pivot_mm = fit_of.centroid_part_mm;
  difference.step = step_between(RigidTransform{}, fit_from.part_from_mcs * fit_of.part_from_mcs.inverse(),
                                 difference.pivot_mm);
  difference.covariance =
      covariance_about(fit_of, difference.pivot_mm) + covariance_about(fit_from, difference.pivot_mm);
  mark_undetermined(fit_of, difference.determined);
  mark_undetermined(fit_from, difference.determined);
  return difference;
}

}  // namespace trueblade
