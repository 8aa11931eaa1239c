#include "part/mean_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "part/cad_spline.h"

namespace trueblade {

namespace {

struct Outline {
  Handle(Geom_BSplineCurve) curve;  // from the trailing edge over the upper side and back along the lower one
  double nose;                      // parameter of the foremost point
};

// Centripetal parameters (Lee 1989): no overshoot between the crowded points of the nose and the sparse ones
// behind it.
Outline outline_of(const AirfoilSection& section) {
  std::vector<double> parameters{0.0};
  std::vector<Vec3> points;
  std::size_t nose = 0;
  for (std::size_t i = 0; i < section.outline.size(); ++i) {
    const Vec2& point = section.outline[i];
    if (i > 0) parameters.push_back(parameters.back() + std::sqrt((point - section.outline[i - 1]).norm()));
    if (point.x() < section.outline[nose].x()) nose = i;
    points.emplace_back(point.x(), point.y(), 0.0);
  }
  return {curve_of(not_a_knot_spline(parameters, points)), parameters[nose]};
}

// Radius of the circle that touches the outline at `point` (inward unit normal `inward`) and passes through
// `other`: |point + radius * inward - other| = radius.
double radius_through(const Vec3& point, const Vec3& inward, const Vec3& other) {
  const Vec3 apart = other - point;
  const double depth = 2.0 * inward.dot(apart);
  return depth > 0.0 ? apart.squaredNorm() / depth : std::numeric_limits<double>::infinity();
}

// The largest circle inside the outline that touches it at `point`: the least radius over the points of the
// lower side.
double inscribed_radius(const Outline& outline, const Vec3& point, const Vec3& inward) {
  const auto radius_at = [&](double parameter) {
    return radius_through(point, inward, from_gp(outline.curve->Value(parameter).XYZ()));
  };
  constexpr int kCoarseSteps = 200;
  const double step = (outline.curve->LastParameter() - outline.nose) / kCoarseSteps;
  double best = outline.nose;
  for (int i = 1; i <= kCoarseSteps; ++i)
    if (const double parameter = outline.nose + i * step; radius_at(parameter) < radius_at(best))
      best = parameter;
  double low = std::max(best - step, outline.nose);
  double high = std::min(best + step, outline.curve->LastParameter());
  // Thirds: 40 rounds shrink the bracket by (2/3)^40 = 1e-7 of a step; the radius is stationary there.
  for (int round = 0; round < 40; ++round) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (radius_at(a) < radius_at(b) ? high : low) = radius_at(a) < radius_at(b) ? b : a;
  }
  return radius_at(0.5 * (low + high));
}

}  // namespace

MeanLine::MeanLine(const AirfoilSection& section) {
  const Outline outline = outline_of(section);
  constexpr int kCircles = 80;  // three per point of a usual file
  std::vector<double> stations;
  std::vector<Vec3> circles;
  for (int i = kCircles - 1; i >= 1; --i) {
    gp_Pnt on_curve;
    gp_Vec along;
    outline.curve->D1(outline.nose * i / kCircles, on_curve, along);
    const Vec3 point = from_gp(on_curve.XYZ());
    const Vec3 tangent = from_gp(along.XYZ()).normalized();
    const Vec3 inward(-tangent.y(), tangent.x(), 0.0);  // the outline runs counter-clockwise
    const double radius = inscribed_radius(outline, point, inward);
    const Vec3 centre = point + radius * inward;
    if (!std::isfinite(radius) || radius > 0.5) continue;
    // At the very nose the circles crowd at its centre of curvature; a thousandth of the chord keeps them
    // apart.
    if (!stations.empty() && centre.x() < stations.back() + 1e-3) continue;
    stations.push_back(centre.x());
    circles.emplace_back(centre.x(), centre.y(), radius);
  }
  if (stations.size() < 8 || stations.front() > 0.1 || stations.back() < 0.9)
    throw InputError("section \"" + section.name + "\" encloses no mean line from nose to tail");
  curve_ = curve_of(not_a_knot_spline(stations, circles));

  x_of_largest_radius_ = first_x();
  for (const double x : equally_spaced(first_x(), last_x(), 4000))
    if (at(x).radius > at(x_of_largest_radius_).radius) x_of_largest_radius_ = x;
}

MeanLine::Circle MeanLine::at(double x) const {
  gp_Pnt circle;
  gp_Vec by_x;
  curve_->D1(x, circle, by_x);
  return {{circle.X(), circle.Y()}, {by_x.X(), by_x.Y()}, circle.Z(), by_x.Z()};
}

}  // namespace trueblade
