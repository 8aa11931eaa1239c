#include "inspection/section_rigid_fit.h"

#include <Eigen/Dense>
#include <vector>

namespace trueblade {

std::optional<SectionRigidFit> fit_section_rigidly(const SectionOutline& outline,
                                                   std::span<const SectionPoint> points,
                                                   std::span<const double> weight) {
  Mat3 information = Mat3::Zero(), scatter = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  std::vector<Vec3> rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 arm = outline.point_mm[points[i].outline_point] - outline.centroid_mm;
    const Vec2& n = outline.normal[points[i].outline_point];
    rows.emplace_back(arm.x() * n.y() - arm.y() * n.x(), n.x(), n.y());
    information += weight[i] * rows.back() * rows.back().transpose();
    right += weight[i] * points[i].deviation_mm * rows.back();
  }
  const Eigen::FullPivLU<Mat3> solver(information);
  if (!solver.isInvertible()) return std::nullopt;
  const Vec3 fit = solver.solve(right);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double residual = points[i].deviation_mm - rows[i].dot(fit);
    scatter += weight[i] * weight[i] * residual * residual * rows[i] * rows[i].transpose();
  }
  const Mat3 inverse = information.inverse();
  return SectionRigidFit{fit, (inverse * scatter * inverse).diagonal().cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace trueblade
