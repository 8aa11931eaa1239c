#include "part/blade_section.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace trueblade {

namespace {

constexpr double kSuction = 1.0, kPressure = -1.0;

Vec2 turned(const Vec2& v, double angle) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(),
          std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

double direction(const Vec2& v) {
  return std::atan2(v.y(), v.x());
}

// Area centroid of a polygon.
Vec2 centroid_of(const std::vector<Vec2>& polygon) {
  double twice_area = 0.0;
  Vec2 moment = Vec2::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double cross = a.x() * b.y() - b.x() * a.y();
    twice_area += cross;
    moment += cross * (a + b);
  }
  return moment / (3.0 * twice_area);
}

}  // namespace

BladeSection::BladeSection(const MeanLine& mean_line, const SectionSize& size, const std::string& where)
    : mean_line_(&mean_line),
      size_(size),
      thickness_scale_(0.5 * size.max_thickness_mm / mean_line.at(mean_line.x_of_largest_radius()).radius),
      leading_x_(find_leading_x(where)),
      trailing_x_(find_trailing_x(where)) {
  // The chord is the distance of the arcs' centres and both radii: that distance scales with the length.
  const double unit_distance = (disc_at(trailing_x_).centre - disc_at(leading_x_).centre).norm();
  length_scale_ =
      (size.chord_mm - size.leading_edge_radius_mm - size.trailing_edge_radius_mm) / unit_distance;
  require_room_for_arcs(where);
  place();
}

BladeSection::Disc BladeSection::disc_at(double x) const {
  const MeanLine::Circle circle = mean_line_->at(x);
  const Vec2 centre_by_x =
      length_scale_ * Vec2(circle.centre_by_x.x(), size_.camber_factor * circle.centre_by_x.y());
  return {length_scale_ * Vec2(circle.centre.x(), size_.camber_factor * circle.centre.y()),
          thickness_scale_ * circle.radius, centre_by_x.normalized(),
          thickness_scale_ * circle.radius_by_x / centre_by_x.norm()};
}

double BladeSection::find_leading_x(const std::string& where) const {
  double thin = mean_line_->first_x(), thick = mean_line_->x_of_largest_radius();
  const auto radius = [&](double x) { return thickness_scale_ * mean_line_->at(x).radius; };
  if (!(size_.leading_edge_radius_mm > radius(thin) && size_.leading_edge_radius_mm < radius(thick)))
    throw InputError(
        fmt::format("{}_leading_edge_radius_mm is {}, must be between {:.3g} (the section's own nose) and "
                    "{:.3g} (half its thickness)",
                    where, size_.leading_edge_radius_mm, radius(thin), radius(thick)));
  // 60 halvings: to rounding.
  for (int i = 0; i < 60; ++i)
    (radius(0.5 * (thin + thick)) < size_.leading_edge_radius_mm ? thin : thick) = 0.5 * (thin + thick);
  return 0.5 * (thin + thick);
}

double BladeSection::find_trailing_x(const std::string& where) const {
  double thin = mean_line_->last_x(), thick = mean_line_->x_of_largest_radius();
  const auto radius = [&](double x) { return thickness_scale_ * mean_line_->at(x).radius; };
  if (!(size_.trailing_edge_radius_mm > radius(thin) && size_.trailing_edge_radius_mm < radius(thick)))
    throw InputError(
        fmt::format("{}_trailing_edge_radius_mm is {}, must be between {:.3g} (the section's own tail) and "
                    "{:.3g} (half its thickness)",
                    where, size_.trailing_edge_radius_mm, radius(thin), radius(thick)));
  for (int i = 0; i < 60; ++i)
    (radius(0.5 * (thin + thick)) < size_.trailing_edge_radius_mm ? thin : thick) = 0.5 * (thin + thick);
  return 0.5 * (thin + thick);
}

// The chord line must leave through the arcs, or the section would be longer than its chord says; 5 degrees
// of arc beside it keep every piece of the outline longer than a twelfth of the radius.
void BladeSection::require_room_for_arcs(const std::string& where) const {
  const Vec2 chord_line = disc_at(trailing_x_).centre - disc_at(leading_x_).centre;
  constexpr double kLeastArc = 5.0 * std::numbers::pi / 180.0;
  const auto check = [&](double x, double radius_growth, const char* edge, double radius_mm) {
    const Disc disc = disc_at(x);
    const double camber = std::abs(direction(disc.forward) - direction(chord_line));
    const double half_arc = std::acos(std::clamp(radius_growth, -1.0, 1.0));
    if (!(std::abs(radius_growth) < 1.0 && half_arc > camber + kLeastArc))
      throw InputError(
          fmt::format("{0}_{1}_edge_radius_mm is {2}, too small for the thick or cambered {1} edge of this "
                      "section: an arc of "
                      "this radius would not reach the chord line",
                      where, edge, radius_mm));
  };
  check(leading_x_, disc_at(leading_x_).radius_by_length, "leading", size_.leading_edge_radius_mm);
  check(trailing_x_, -disc_at(trailing_x_).radius_by_length, "trailing", size_.trailing_edge_radius_mm);
}

// Where the envelope of the circles touches this one: outward normal with the component -dr/ds along the mean
// line.
Vec2 BladeSection::normal_on(const Disc& disc, double side) const {
  const Vec2 left(-disc.forward.y(), disc.forward.x());
  return -disc.radius_by_length * disc.forward +
         side * std::sqrt(1.0 - disc.radius_by_length * disc.radius_by_length) * left;
}

// From nose (0) to tail (1): three times as dense at both ends, where the sides curve or meet the arcs.
double BladeSection::x_along_side(double along) const {
  constexpr double kGrading = 0.7;
  const double graded =
      (1.0 - kGrading) * along + kGrading * 0.5 * (1.0 - std::cos(std::numbers::pi * along));
  return leading_x_ + (trailing_x_ - leading_x_) * graded;
}

Vec2 BladeSection::raw_normal(SectionPiece piece, double along) const {
  // An arc runs from its middle, on the mean line, to where the side of the same name leaves the disc.
  const auto on_nose = [&](double side, double from_middle) {
    const Disc disc = disc_at(leading_x_);
    return turned(-disc.forward, -side * std::acos(disc.radius_by_length) * from_middle);
  };
  const auto on_tail = [&](double side, double from_middle) {
    const Disc disc = disc_at(trailing_x_);
    return turned(disc.forward, side * std::acos(-disc.radius_by_length) * from_middle);
  };
  switch (piece) {
    case SectionPiece::leading_suction:
      return on_nose(kSuction, along);
    case SectionPiece::suction:
      return normal_on(disc_at(x_along_side(along)), kSuction);
    case SectionPiece::trailing_suction:
      return on_tail(kSuction, 1.0 - along);
    case SectionPiece::trailing_pressure:
      return on_tail(kPressure, along);
    case SectionPiece::pressure:
      return normal_on(disc_at(x_along_side(1.0 - along)), kPressure);
    case SectionPiece::leading_pressure:
      return on_nose(kPressure, 1.0 - along);
  }
  return Vec2::Zero();
}

Vec2 BladeSection::raw_point(SectionPiece piece, double along) const {
  double x = leading_x_;
  if (piece == SectionPiece::suction) x = x_along_side(along);
  if (piece == SectionPiece::pressure) x = x_along_side(1.0 - along);
  if (piece == SectionPiece::trailing_suction || piece == SectionPiece::trailing_pressure) x = trailing_x_;
  const Disc disc = disc_at(x);
  return disc.centre + disc.radius * raw_normal(piece, along);
}

Vec2 BladeSection::unit_tangent(SectionPiece piece, double along) const {
  const Vec2 outward = placed_rotation_ * raw_normal(piece, along);
  return {outward.y(), -outward.x()};  // clockwise
}

void BladeSection::place() {
  const Vec2 chord_line = disc_at(trailing_x_).centre - disc_at(leading_x_).centre;
  placed_rotation_ = Eigen::Rotation2Dd(size_.stagger_rad - direction(chord_line)).toRotationMatrix();
  std::vector<Vec2> polygon;
  constexpr int kCorners = 200;  // per piece: the centroid is then exact to 1e-5 of the thickness
  for (const SectionPiece piece : kSectionPieces)
    for (int i = 0; i < kCorners; ++i)
      polygon.push_back(placed_rotation_ * raw_point(piece, static_cast<double>(i) / kCorners));
  placed_shift_ = -centroid_of(polygon);
}

}  // namespace trueblade
