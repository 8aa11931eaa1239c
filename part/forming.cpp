#include "part/forming.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace trueblade {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// From 0 to 1 with two vanishing derivatives at both ends; its steepest slope is 15/8.
double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}
constexpr double kSteepestSlope = 15.0 / 8.0;

}  // namespace

// The heading turns fastest in the middle of a bend, by angle * 15/8 / width = 1 / radius.
double bend_width_mm(const FormedPartParameters& p, double bend_deg) {
  return kSteepestSlope * p.bend_radius_mm * (bend_deg + p.bend_twist_deg) * kDegree;
}

Forming::Forming(const FormedPartParameters& p)
    : parameters_(p),
      front_bend_(p.front_bend_deg * kDegree),
      back_bend_(p.back_bend_deg * kDegree),
      front_bend_width_(bend_width_mm(p, p.front_bend_deg)),
      back_bend_width_(bend_width_mm(p, p.back_bend_deg)) {
  const double half = 0.5 * p.panel_mm;
  across_borders_ = {-half - front_bend_width_ - p.front_flange_mm,
                     -half - front_bend_width_,
                     -half,
                     -half / 3.0,
                     half / 3.0,
                     half,
                     half + back_bend_width_,
                     half + back_bend_width_ + p.back_flange_mm};

  // Beads along the outer thirds of the panel, a cup between them, darts across the bends.
  const double third = p.panel_mm / 3.0, ramp = kRampToPanel * p.panel_mm;
  bumps_.push_back({-third, 0.0, 0.0, 0.30 * p.length_mm, 0.5, ramp, p.bead_height_mm});
  bumps_.push_back({third, -0.06 * p.length_mm, 0.0, 0.22 * p.length_mm, 0.5, ramp, p.bead_height_mm});
  bumps_.push_back(
      {0.0, 0.0, 0.0, 0.04 * p.length_mm, 0.6 * p.hole_diameter_mm, 1.2 * ramp, p.bead_height_mm});
  const auto add_dart = [&](double bend, double bend_width, double along) {
    bumps_.push_back(
        {bend, along * p.length_mm, 0.2 * bend_width, 0.0, 0.0, kRampToBend * bend_width, -p.dart_depth_mm});
  };
  for (const double along : {-0.3, 0.0, 0.3})
    add_dart(-half - 0.5 * front_bend_width_, front_bend_width_, along);
  for (const double along : {-0.2, 0.2}) add_dart(half + 0.5 * back_bend_width_, back_bend_width_, along);
}

// Direction of the sheet across the part, in the plane of y and z: up the front flange, over the panel, down
// the back flange.
Forming::Heading Forming::heading(double across, double along) const {
  const double half = 0.5 * parameters_.panel_mm, twist = parameters_.bend_twist_deg * kDegree * along;
  const double front =
      (front_bend_ + twist) * (1.0 - smooth_step((across + half + front_bend_width_) / front_bend_width_));
  const double back = (back_bend_ - twist) * smooth_step((across - half) / back_bend_width_);
  const double crown = parameters_.crosswise_crown_deg * kDegree * across / parameters_.panel_mm;
  const double angle = front - back - crown;
  return {std::sin(angle), std::cos(angle)};
}

double Forming::height(double across, double along) const {
  const double along_mm = 0.5 * parameters_.length_mm * along;
  double height_mm = 0.0;
  for (const Bump& bump : bumps_) {
    const double beside = std::max(std::abs(across - bump.across) - bump.half_across_mm, 0.0);
    const double beyond = std::max(std::abs(along_mm - bump.along_mm) - bump.half_along_mm, 0.0);
    height_mm +=
        bump.height_mm * (1.0 - smooth_step((std::hypot(beside, beyond) - bump.top_mm) / bump.ramp_mm));
  }
  return height_mm;
}

Vec3 Forming::point(double across, double along) const {
  // Gauss-Legendre with three points in intervals of at most a quarter of a bend.
  constexpr std::array<double, 3> kNode = {-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const int intervals = 24;
  const double step = across / intervals;
  double y = 0.0, z = 0.0;
  for (int i = 0; i < intervals; ++i)
    for (std::size_t k = 0; k < kNode.size(); ++k) {
      const Heading direction = heading(step * (i + 0.5 + 0.5 * kNode[k]), along);
      y += kWeight[k] * step * direction.cosine;
      z += kWeight[k] * step * direction.sine;
    }
  const Heading direction = heading(across, along);
  const double raised = height(across, along);
  y -= raised * direction.sine;
  z += raised * direction.cosine;

  // Ends cut to a curve, part swept along a gentle S in plan and a crown in elevation.
  const double to_flange = across / across_borders_.back();
  const double x = 0.5 * parameters_.length_mm * along * (1.0 - 0.05 * to_flange * to_flange);
  const double sway = 0.012 * parameters_.length_mm * std::sin(0.5 * std::numbers::pi * along);
  return {x, y + sway, z - parameters_.lengthwise_crown_mm * along * along};
}

Vec3 Forming::normal(double across, double along) const {
  // Central differences: h^2 times the third derivative (below 1 / mm^2) is 1e-8.
  constexpr double h = 1e-4;
  const double h_along = h / (0.5 * parameters_.length_mm);
  const Vec3 by_across = point(across + h, along) - point(across - h, along);
  const Vec3 by_along = point(across, along + h_along) - point(across, along - h_along);
  return by_along.cross(by_across).normalized();
}

std::vector<Vec2> Forming::hole_centres() const {
  return {{0.0, 0.0}, {0.0, -0.7}, {0.0, 0.7}};
}

}  // namespace trueblade
