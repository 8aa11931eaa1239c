#include "inspection/section_features.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trueblade {
namespace {

// The convex hull holds the farthest pair; monotone chain (Andrew 1979), indices into the outline.
std::vector<std::size_t> convex_hull(const std::vector<Vec2>& points) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(points[a].x(), points[a].y()) < std::make_pair(points[b].x(), points[b].y());
  });
  const auto turns_left = [&](std::size_t a, std::size_t b, std::size_t c) {
    const Vec2 u = points[b] - points[a], v = points[c] - points[b];
    return u.x() * v.y() - u.y() * v.x() > 0.0;
  };
  std::vector<std::size_t> hull;
  const auto extend = [&](auto begin, auto end, std::size_t keep) {
    for (auto i = begin; i != end; ++i) {
      while (hull.size() > keep && !turns_left(hull[hull.size() - 2], hull.back(), *i)) hull.pop_back();
      hull.push_back(*i);
    }
  };
  extend(order.begin(), order.end(), 1);
  extend(order.rbegin() + 1, order.rend(), hull.size());
  hull.pop_back();  // the first point again
  return hull;
}

// A corner sharper than this is the end itself; a parabola through its neighbours would pass outside of it.
// The facets of an edge turn by less.
const double kCornerCosine = std::cos(30.0 * std::numbers::pi / 180.0);

struct SupportPoint {
  std::size_t nearest;  // point of the outline
  Vec2 point_mm;
};

// The farthest point of the outline in this direction, in the neighbourhood of `start`.
SupportPoint support_point(const SectionOutline& outline, std::size_t start, const Vec2& direction) {
  const std::size_t n = outline.size();
  const auto height_mm = [&](std::size_t i) { return direction.dot(outline.point_mm[i % n]); };
  std::size_t i = start;
  for (std::size_t steps = 0; steps < n && height_mm(i + 1) > height_mm(i); ++steps) i = (i + 1) % n;
  for (std::size_t steps = 0; steps < n && height_mm(i + n - 1) > height_mm(i); ++steps) i = (i + n - 1) % n;

  const Vec2 &before = outline.point_mm[(i + n - 1) % n], &here = outline.point_mm[i],
             &after = outline.point_mm[(i + 1) % n];
  const double a = (here - before).norm(), b = (after - here).norm();
  if ((here - before).dot(after - here) < kCornerCosine * a * b) return {i, here};
  // here + t slope + t^2 bend, at -a the point before and at b the one after.
  const Vec2 slope = (b / a * (here - before) + a / b * (after - here)) / (a + b);
  const Vec2 bend = ((after - here) / b - (here - before) / a) / (a + b);
  const double curvature = direction.dot(bend);
  if (curvature >= 0.0) return {i, here};  // a straight stretch across the direction
  const double t = std::clamp(-direction.dot(slope) / (2.0 * curvature), -a, b);
  return {i, here + t * slope + t * t * bend};
}

// Radius of the circle that touches the outline at `touch` from inside and passes through `other`.
double tangent_radius(const SectionOutline& outline, std::size_t touch, std::size_t other) {
  const Vec2 d = outline.point_mm[touch] - outline.point_mm[other];
  const double inward = d.dot(outline.normal[touch]);
  return inward > 0.0 ? d.squaredNorm() / (2.0 * inward) : std::numeric_limits<double>::infinity();
}

}  // namespace

Chord maximum_chord(const SectionOutline& outline) {
  const std::vector<std::size_t> hull = convex_hull(outline.point_mm);
  Chord chord{0, 0, 0.0, 0.0};
  for (std::size_t i = 0; i < hull.size(); ++i) {
    for (std::size_t j = i + 1; j < hull.size(); ++j) {
      const double length = (outline.point_mm[hull[i]] - outline.point_mm[hull[j]]).norm();
      if (length > chord.length_mm) chord = {hull[i], hull[j], length, 0.0};
    }
  }
  if (outline.point_mm[chord.leading].x() > outline.point_mm[chord.trailing].x()) {
    std::swap(chord.leading, chord.trailing);
  }
  // Each end is the farthest point along the chord; an end moves by its edge radius times the chord's turn,
  // so that a step leaves radius / length of the error before: a hundredth.
  Vec2 along = outline.point_mm[chord.trailing] - outline.point_mm[chord.leading];
  for (int step = 0; step < 10; ++step) {
    const SupportPoint trailing = support_point(outline, chord.trailing, along);
    const SupportPoint leading = support_point(outline, chord.leading, -along);
    along = trailing.point_mm - leading.point_mm;
    chord.trailing = trailing.nearest;
    chord.leading = leading.nearest;
  }
  chord.length_mm = along.norm();
  chord.stagger_rad = std::atan2(along.y(), along.x());
  return chord;
}

InscribedCircle largest_inscribed_circle(const SectionOutline& outline, std::size_t start) {
  InscribedCircle largest{Vec2::Zero(), 0.0, 0, 0};
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const std::size_t touch = (start + k) % outline.size();
    double radius = std::numeric_limits<double>::infinity();
    std::size_t opposite = touch;
    for (std::size_t other = 0; other < outline.size(); ++other) {
      if (other == touch) continue;
      const double r = tangent_radius(outline, touch, other);
      if (r < radius) radius = r, opposite = other;
      if (2.0 * radius <= largest.diameter_mm) break;  // it cannot become the largest
    }
    if (!std::isfinite(radius) || 2.0 * radius <= largest.diameter_mm) continue;
    largest = {outline.point_mm[touch] - radius * outline.normal[touch], 2.0 * radius, touch, opposite};
  }
  return largest;
}

std::vector<std::size_t> edge_region(const SectionOutline& outline, std::size_t apex, const Vec2& direction) {
  const double smallest_cosine = std::cos(50.0 * std::numbers::pi / 180.0);
  const std::size_t n = outline.size();
  const auto belongs = [&](std::size_t i) { return outline.normal[i].dot(direction) >= smallest_cosine; };
  std::size_t before = 0, after = 0;  // points on either side of the apex
  while (before + 1 < n && belongs((apex + n - before - 1) % n)) ++before;
  while (before + after + 1 < n && belongs((apex + after + 1) % n)) ++after;
  std::vector<std::size_t> region;
  for (std::size_t k = 0; k <= before + after; ++k) region.push_back((apex + n - before + k) % n);
  return region;
}

std::optional<FittedCircle> fit_circle(std::span<const Vec2> points_mm) {
  const auto n = static_cast<Eigen::Index>(points_mm.size());
  if (n < 4) return std::nullopt;
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points_mm) mean += p / static_cast<double>(n);

  // Algebraic fit: 2 c . p + (r^2 - c^2) = p^2, about the mean (Kasa 1976).
  Eigen::MatrixXd a(n, 3);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec2 p = points_mm[static_cast<std::size_t>(i)] - mean;
    a.row(i) << 2.0 * p.x(), 2.0 * p.y(), 1.0;
    b[i] = p.squaredNorm();
  }
  const auto algebraic = a.colPivHouseholderQr();
  if (algebraic.rank() < 3) return std::nullopt;
  const Vec3 start = algebraic.solve(b);
  Vec2 centre = start.head<2>();
  double radius = std::sqrt(std::max(start[2] + centre.squaredNorm(), 0.0));

  // Geometric fit: residual |p - c| - r. It starts close and ends when a step no longer matters; 50 steps are
  // ten times what it takes.
  Eigen::MatrixXd j(n, 3);
  Eigen::VectorXd residual(n);
  for (int iteration = 0; iteration < 50; ++iteration) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec2 d = points_mm[static_cast<std::size_t>(i)] - mean - centre;
      const double distance = d.norm();
      if (distance == 0.0) return std::nullopt;
      residual[i] = distance - radius;
      j.row(i) << -d.x() / distance, -d.y() / distance, -1.0;
    }
    const Vec3 step = -j.colPivHouseholderQr().solve(residual);
    if (!step.allFinite()) return std::nullopt;
    centre += step.head<2>();
    radius += step[2];
    if (step.norm() < 1e-12 * radius) break;
  }
  const double squares = residual.squaredNorm();
  const Mat3 covariance = (j.transpose() * j).inverse() * (squares / static_cast<double>(n - 3));
  return FittedCircle{centre + mean, radius, std::sqrt(squares / static_cast<double>(n)),
                      std::sqrt(std::max(covariance(2, 2), 0.0))};
}

}  // namespace trueblade
