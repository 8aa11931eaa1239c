#include "inspection/deviation_uncertainty.h"

#include <Eigen/Geometry>
#include <cmath>

namespace trueblade {

std::vector<double> deviation_uncertainty_mm(const Deviations& deviations,
                                             const RegistrationResult& registration, double point_sigma_mm) {
  std::vector<double> uncertainty_mm(deviations.size());
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const Vec3 arm = deviations.point_mm[i] - registration.centroid_part_mm;
    Vec6 j;
    j << arm.cross(deviations.normal[i]), deviations.normal[i];
    const double pose_variance = j.dot(registration.covariance * j);
    uncertainty_mm[i] = std::sqrt(point_sigma_mm * point_sigma_mm + std::max(pose_variance, 0.0));
  }
  return uncertainty_mm;
}

}  // namespace trueblade
