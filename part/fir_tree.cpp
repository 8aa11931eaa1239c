#include "part/fir_tree.h"

#include <cmath>
#include <numbers>

#include "part/require_parameter.h"

namespace trueblade {

namespace {

// Heights within one tooth as parts of the pitch: bearing flank, crest, free flank. With the default pitch
// and depth the bearing flank lies 40 degrees, the free flank 60 degrees off the horizontal.
constexpr double kBearingFlank = 0.23, kCrest = 0.27, kFreeFlank = 0.50;

// Corners of the suction side from a point on the platform's underside down to the bottom, before rounding.
std::vector<Vec2> suction_side_corners(const TurbineBladeParameters& p) {
  const double underside = -p.platform_thickness_mm;
  const double teeth_top = underside - p.root_neck_height_mm;
  const double bottom = underside - p.root_height_mm;
  const double pitch = (teeth_top - bottom) / p.root_teeth;
  const double taper = std::tan(p.root_taper_deg * std::numbers::pi / 180.0);
  const auto valley_half_width = [&](double z) {
    return 0.5 * p.root_neck_width_mm - taper * (teeth_top - z);
  };
  const auto crest_half_width = [&](double z) { return valley_half_width(z) + p.root_tooth_depth_mm; };
  require_parameter(valley_half_width(bottom) > p.root_corner_radius_mm, "root_taper_deg", p.root_taper_deg,
                    "small enough to leave a bottom to the root");

  std::vector<Vec2> corners = {{0.5 * p.root_neck_width_mm + 10.0 * p.root_corner_radius_mm, underside},
                               {0.5 * p.root_neck_width_mm, underside}};
  for (int tooth = 0; tooth < p.root_teeth; ++tooth) {
    const double top = teeth_top - pitch * tooth;
    const double crest_top = top - kBearingFlank * pitch, crest_bottom = crest_top - kCrest * pitch;
    corners.emplace_back(valley_half_width(top), top);
    corners.emplace_back(crest_half_width(crest_top), crest_top);
    corners.emplace_back(crest_half_width(crest_bottom), crest_bottom);
  }
  corners.emplace_back(valley_half_width(bottom), bottom);
  return corners;
}

// Every inner corner replaced by an arc; the first and the last line are left out.
std::vector<OutlinePiece> rounded(const std::vector<Vec2>& corners, double radius_mm) {
  std::vector<OutlinePiece> pieces;
  double room = 0.0;  // on the line that leads to the corner
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec2 in = (corners[i] - corners[i - 1]).normalized(),
               out = (corners[i + 1] - corners[i]).normalized();
    const double half_turn = 0.5 * std::acos(in.dot(out));
    const double tangent_length = radius_mm * std::tan(half_turn);
    const Vec2 first = corners[i] - tangent_length * in, last = corners[i] + tangent_length * out;
    const Vec2 to_centre = (out - in).normalized();
    const Vec2 middle = corners[i] + radius_mm * (1.0 / std::cos(half_turn) - 1.0) * to_centre;
    if (i > 1) {
      require_parameter(
          room > tangent_length, "root_corner_radius_mm", radius_mm,
          fmt::format("small enough for two arcs to fit a line of the fir tree (a line of {:.3g} mm is left)",
                      room));
      pieces.push_back({"", pieces.back().last, {}, first, false});
    }
    pieces.push_back({"", first, middle, last, true});
    room = (corners[i + 1] - corners[i]).norm() - tangent_length;
  }
  return pieces;
}

}  // namespace

std::vector<OutlinePiece> fir_tree_outline(const TurbineBladeParameters& parameters) {
  std::vector<Vec2> corners = suction_side_corners(parameters);
  for (std::size_t i = corners.size(); i-- > 0;) corners.emplace_back(-corners[i].x(), corners[i].y());
  std::vector<OutlinePiece> pieces = rounded(corners, parameters.root_corner_radius_mm);
  const std::size_t side = pieces.size() / 2;  // of the one piece at the bottom
  for (std::size_t i = 0; i < pieces.size(); ++i)
    pieces[i].name = i < side    ? fmt::format("root_suction_{}", i + 1)
                     : i == side ? "root_bottom"
                                 : fmt::format("root_pressure_{}", pieces.size() - i);
  return pieces;
}

}  // namespace trueblade
