#include "part/blade_fillet.h"

#include <cmath>
#include <numbers>

#include "part/cad_spline.h"

namespace trueblade {

namespace {

// The airfoil on the fillet's upper border, at one u.
struct BorderPoint {
  Vec3 point, by_u, by_z, by_u_z;
  Vec3 tangent;       // unit, along the border
  double turn_per_u;  // of the tangent, counter-clockwise
};

BorderPoint border_at(const Handle(Geom_BSplineSurface) & airfoil, double u, double z) {
  gp_Pnt point;
  gp_Vec by_u, by_z, by_u_u, by_z_z, by_u_z;
  airfoil->D2(u, z, point, by_u, by_z, by_u_u, by_z_z, by_u_z);
  BorderPoint border{
      from_gp(point.XYZ()), from_gp(by_u.XYZ()), from_gp(by_z.XYZ()), from_gp(by_u_z.XYZ()), {}, 0.0};
  border.tangent = border.by_u.normalized();
  border.turn_per_u = (by_u.X() * by_u_u.Y() - by_u.Y() * by_u_u.X()) / by_u.SquareMagnitude();
  return border;
}

// A row of the fillet's poles as a curve of u: where it is, and how fast it runs along the border's tangent.
struct RowPoint {
  Vec3 point;
  double speed;
};

// The curve parallel to the border at `distance_mm` outside it, laid down on the platform.
RowPoint on_platform(const BorderPoint& border, double distance_mm) {
  const Vec3 outside(-border.tangent.y(), border.tangent.x(), 0.0);  // left of a clockwise curve
  const Vec3 point = border.point + distance_mm * outside;
  return {{point.x(), point.y(), 0.0}, border.by_u.norm() - distance_mm * border.turn_per_u};
}

// On the airfoil's tangents, `depth_mm` lower.
RowPoint below_border(const BorderPoint& border, double depth_mm) {
  return {border.point - depth_mm * border.by_z,
          (border.by_u - depth_mm * border.by_u_z).dot(border.tangent)};
}

// Every row ends in the direction of the border's tangent: then the derivatives across a joint of two strips,
// sums of the rows' ends with different speeds, are parallel all along it.
std::vector<Vec3> poles_of_row(const std::vector<BorderPoint>& border, const std::vector<double>& parameters,
                               const auto& row) {
  CurveSamples samples{parameters, {}, {}, {}};
  for (const BorderPoint& each : border) samples.points.push_back(row(each).point);
  samples.first_derivative = row(border.front()).speed * border.front().tangent;
  samples.last_derivative = row(border.back()).speed * border.back().tangent;
  return complete_spline(samples).poles;
}

}  // namespace

Handle(Geom_BSplineSurface)
    blade_fillet(const Handle(Geom_BSplineSurface) & airfoil, int intervals, double radius_mm) {
  // Handle length of the cubic that passes through the middle of a quarter circle; its radius is right
  // to 2.7e-4.
  const double handle_mm = 4.0 / 3.0 * (std::numbers::sqrt2 - 1.0) * radius_mm;
  const std::vector<double> parameters = equally_spaced(0.0, 1.0, intervals);
  std::vector<BorderPoint> border;
  for (const double u : parameters) border.push_back(border_at(airfoil, u, radius_mm));

  const auto row = [&](const auto& point) { return poles_of_row(border, parameters, point); };
  const std::vector<std::vector<Vec3>> rows = {
      row([&](const BorderPoint& b) { return on_platform(b, radius_mm); }),
      row([&](const BorderPoint& b) { return on_platform(b, radius_mm - handle_mm); }),
      row([&](const BorderPoint& b) { return below_border(b, handle_mm); }),
      row([&](const BorderPoint& b) { return below_border(b, 0.0); })};
  std::vector<double> flat_knots;
  for (const double knot : airfoil->UKnotSequence()) flat_knots.push_back(knot);
  return surface_of(flat_knots, {0, 0, 0, 0, 1, 1, 1, 1}, rows);
}

}  // namespace trueblade
