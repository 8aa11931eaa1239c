#include "inspection/section_rigid_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace trueblade {
namespace {

// The outline beside a point: the segment that is nearest, of those at the nearest outline point.
struct Beside {
  std::size_t outline_point;
  double signed_mm;  // outside is positive
  Vec2 normal;       // between those at the ends of the segment: smooth, so that a round outline stays round
  Vec2 foot_mm;
};

// The place of a segment that is nearest to a point: its share of the way from one end to the other.
struct SegmentPlace {
  double along;
  double squared_distance_mm2;
};
SegmentPlace nearest_place(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 way = to - from;
  const double along = std::clamp((point - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return {along, (from + along * way - point).squaredNorm()};
}

// Walks along the outline from `start` for as long as it comes nearer.
Beside beside(const SectionOutline& outline, const Vec2& point, std::size_t start) {
  const std::size_t n = outline.size();
  const auto squared = [&](std::size_t i) { return (outline.point_mm[i] - point).squaredNorm(); };
  std::size_t nearest = start;
  for (const std::size_t step : {std::size_t{1}, n - 1})
    while (squared((nearest + step) % n) < squared(nearest)) nearest = (nearest + step) % n;

  const std::size_t before = (nearest + n - 1) % n, after = (nearest + 1) % n;
  const Vec2& here = outline.point_mm[nearest];
  const SegmentPlace on_next = nearest_place(point, here, outline.point_mm[after]);
  const SegmentPlace on_last = nearest_place(point, outline.point_mm[before], here);
  const bool goes_on = on_next.squared_distance_mm2 <= on_last.squared_distance_mm2;
  const std::size_t from = goes_on ? nearest : before, to = goes_on ? after : nearest;
  const Vec2 way = outline.point_mm[to] - outline.point_mm[from];
  const Vec2 across = Vec2(way.y(), -way.x()).normalized();  // the material lies on the left
  const double along = goes_on ? on_next.along : on_last.along;
  const double signed_mm = across.dot(point - here);
  return {nearest, signed_mm,
          ((1.0 - along) * outline.normal[from] + along * outline.normal[to]).normalized(),
          point - signed_mm * across};
}

}  // namespace

std::optional<SectionRigidFit> fit_section_rigidly(const SectionOutline& outline,
                                                   std::span<const PlacedPoint> points,
                                                   std::span<const double> weight) {
  constexpr int kMostSteps = 50;
  // Of any point of the outline; its chords are off the surface by 30 times as much.
  constexpr double kConverged_mm = 1e-6;
  // A motion that moves the points along their normals by a thousandth of itself only (root mean square) is
  // not told by them: a round outline that turns.
  constexpr double kLeastTold = 1e-3;
  double size_mm = 0.0;
  for (const Vec2& point : outline.point_mm)
    size_mm = std::max(size_mm, (point - outline.centroid_mm).norm());

  const double whole_weight = std::accumulate(weight.begin(), weight.end(), 0.0);
  std::vector<std::size_t> places;
  for (const PlacedPoint& point : points) places.push_back(point.outline_point);
  std::vector<Vec3> rows(points.size());
  std::vector<double> residual_mm(points.size());
  Vec3 fit = Vec3::Zero();
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::Rotation2Dd rotation(fit[0]);
    Mat3 information = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2 moved_back =
          outline.centroid_mm +
          rotation.inverse() * Vec2(points[i].point_mm - outline.centroid_mm - fit.tail<2>());
      const Beside at = beside(outline, moved_back, places[i]);
      places[i] = at.outline_point;
      residual_mm[i] = at.signed_mm;
      const Vec2 arm = at.foot_mm - outline.centroid_mm;
      const Vec2 turned = rotation * at.normal;
      rows[i] = {arm.x() * at.normal.y() - arm.y() * at.normal.x(), turned.x(), turned.y()};
      information += weight[i] * rows[i] * rows[i].transpose();
      right += weight[i] * residual_mm[i] * rows[i];
    }
    const Vec3 per_motion(1.0 / size_mm, 1.0, 1.0);
    const Mat3 told = per_motion.asDiagonal() * information * per_motion.asDiagonal();
    const double least_told =
        Eigen::SelfAdjointEigenSolver<Mat3>(told, Eigen::EigenvaluesOnly).eigenvalues()[0];
    if (!(least_told > kLeastTold * kLeastTold * whole_weight)) return std::nullopt;
    const Vec3 change = information.ldlt().solve(right);
    fit += change;
    if (std::abs(change[0]) * size_mm + change.tail<2>().norm() > kConverged_mm) continue;

    Mat3 scatter = Mat3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i)
      scatter += weight[i] * weight[i] * residual_mm[i] * residual_mm[i] * rows[i] * rows[i].transpose();
    const Mat3 inverse = information.inverse();
    return SectionRigidFit{fit, (inverse * scatter * inverse).diagonal().cwiseMax(0.0).cwiseSqrt()};
  }
  return std::nullopt;
}

}  // namespace trueblade
