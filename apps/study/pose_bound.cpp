#include "apps/study/pose_bound.h"

#include <Eigen/Dense>
#include <cmath>

#include "inspection/statistics.h"

namespace trueblade {

Vec6 pose_bound(const Scenario& scenario, const FacetModel& model, const RegisteredPoints& registered,
                const Vec3& pivot_mm) {
  const SensorModel& sensor = scenario.machine.simulation.sensor;
  if (sensor.noise_scale == 0.0) return Vec6::Constant(kNoValue);
  Mat6 information = Mat6::Zero();
  for (const TruePoint& point : registered.points) {
    // The signal that the reading had: its SNR inverted.
    const double signal = sensor.noise_to_signal * std::sqrt(point.snr / (1.0 - point.snr));
    const double sigma_mm =
        distance_sigma_mm(sensor, scenario.machine.lens, signal, point.hit.incidence_cosine) *
        point.hit.incidence_cosine;
    if (!(sigma_mm > 0.0)) continue;
    const Vec3 normal = model.facet_normal(point.hit.facet);
    Vec6 j;
    j << (point.hit.point_pcs_mm - pivot_mm).cross(normal), normal;
    information += j * j.transpose() / (sigma_mm * sigma_mm);
  }
  const Eigen::FullPivLU<Mat6> decomposition(information);
  if (!decomposition.isInvertible()) return Vec6::Constant(kNoValue);
  return decomposition.inverse().diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace trueblade
