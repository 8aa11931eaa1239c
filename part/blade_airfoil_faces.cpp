#include "part/blade_airfoil_faces.h"

#include <fmt/core.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <gp_Pln.hxx>
#include <numbers>

#include "part/blade_fillet.h"
#include "part/blade_section.h"
#include "part/cad_spline.h"

namespace trueblade {

namespace {

// Cubic through equally spaced sections: with 26 degrees of twist over 8 intervals its error is below
// 18 mm * (0.45 / 8)^4 / 384 = 5e-7 mm at the edges.
constexpr int kSectionIntervals = 8;

// One of the six strips around the airfoil, over its whole height and in the fillet.
struct Strip {
  const char* name;
  SectionPiece piece;
  int samples;                                  // intervals along the section
  int patches;                                  // along the section
  Handle(Geom_BSplineSurface) airfoil, fillet;  // u along the section, v from root to tip
};

// Arcs: a cubic through 6 intervals of at most 15 degrees stays within 4e-7 of the radius.
std::vector<Strip> strips_of(const TurbineBladeParameters& parameters) {
  constexpr int kArcIntervals = 6;
  const int side_intervals = 10 * parameters.chordwise_patches;
  return {{"leading_suction", SectionPiece::leading_suction, kArcIntervals, 1, {}, {}},
          {"suction", SectionPiece::suction, side_intervals, parameters.chordwise_patches, {}, {}},
          {"trailing_suction", SectionPiece::trailing_suction, kArcIntervals, 1, {}, {}},
          {"trailing_pressure", SectionPiece::trailing_pressure, kArcIntervals, 1, {}, {}},
          {"pressure", SectionPiece::pressure, side_intervals, parameters.chordwise_patches, {}, {}},
          {"leading_pressure", SectionPiece::leading_pressure, kArcIntervals, 1, {}, {}}};
}

MeanLine mean_line_of(const TurbineBladeParameters& parameters) {
  return MeanLine(parameters.section_file.empty() ? naca_65_section(parameters.section_lift_coefficient)
                                                  : read_airfoil(parameters.section_file));
}

SectionSize section_size_at(const TurbineBladeParameters& p, double z_mm) {
  const auto between = [&](double root, double tip) { return root + (tip - root) * z_mm / p.span_mm; };
  return {between(p.root_chord_mm, p.tip_chord_mm),
          between(p.root_max_thickness_mm, p.tip_max_thickness_mm),
          between(p.root_leading_edge_radius_mm, p.tip_leading_edge_radius_mm),
          between(p.root_trailing_edge_radius_mm, p.tip_trailing_edge_radius_mm),
          between(p.root_camber_factor, p.tip_camber_factor),
          between(p.root_stagger_deg, p.tip_stagger_deg) * std::numbers::pi / 180.0};
}

// The section's own tangents at both ends, so that neighbouring pieces meet without a kink; their length from
// the three-point difference, error h^2 = 1e-8 of itself.
CurveSamples sample_piece(const BladeSection& section, SectionPiece piece, int intervals, double z_mm) {
  const auto point = [&](double along) {
    const Vec2 p = section.point(piece, along);
    return Vec3(p.x(), p.y(), z_mm);
  };
  const auto tangent = [&](double along, double inward) {
    constexpr double h = 1e-4;
    const Vec3 difference =
        (4.0 * point(along + inward * h) - 3.0 * point(along) - point(along + inward * 2.0 * h)) / (2.0 * h);
    const Vec2 direction = section.unit_tangent(piece, along);
    return Vec3(difference.norm() * Vec3(direction.x(), direction.y(), 0.0));
  };
  CurveSamples samples{equally_spaced(0.0, 1.0, intervals), {}, tangent(0.0, 1.0), tangent(1.0, -1.0)};
  for (const double along : samples.parameters) samples.points.push_back(point(along));
  return samples;
}

// The airfoil from the fillet's upper border to the tip: v = z.
Handle(Geom_BSplineSurface) airfoil_strip(const Strip& strip, const std::vector<double>& stations_mm,
                                          const std::vector<BladeSection>& sections) {
  std::vector<std::vector<Vec3>> poles;
  std::vector<double> knots;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const CubicSpline spline =
        complete_spline(sample_piece(sections[i], strip.piece, strip.samples, stations_mm[i]));
    knots = spline.flat_knots;
    poles.push_back(spline.poles);
  }
  return skin(knots, stations_mm, poles);
}

TopoDS_Edge edge_at(const Handle(Geom_BSplineSurface) & patch, double v) {
  return BRepBuilderAPI_MakeEdge(patch->VIso(v));
}

void add_patches(BladeAirfoil& airfoil, const Strip& strip, const TurbineBladeParameters& p,
                 BRepBuilderAPI_MakeWire& footprint, BRepBuilderAPI_MakeWire& tip) {
  const auto add = [&](const std::string& name, const Handle(Geom_BSplineSurface) & patch) {
    airfoil.faces.push_back({name, BRepBuilderAPI_MakeFace(patch, Precision::Confusion())});
  };
  const auto heights = equally_spaced(p.fillet_radius_mm, p.span_mm, p.spanwise_patches);
  const auto borders = equally_spaced(0.0, 1.0, strip.patches);
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const std::string name = strip.patches == 1 ? strip.name : fmt::format("{}_{}", strip.name, i + 1);
    const auto fillet = patch_of(strip.fillet, borders[i], borders[i + 1], 0.0, 1.0);
    add("fillet_" + name, fillet);
    footprint.Add(edge_at(fillet, 0.0));
    for (std::size_t j = 0; j + 1 < heights.size(); ++j) {
      const auto patch = patch_of(strip.airfoil, borders[i], borders[i + 1], heights[j], heights[j + 1]);
      add(fmt::format("{}_span_{}", name, j + 1), patch);
      if (j + 2 == heights.size()) tip.Add(edge_at(patch, p.span_mm));
    }
  }
}

void measure_footprint(BladeAirfoil& airfoil, const std::vector<Strip>& strips) {
  airfoil.footprint_lower = Vec2::Constant(1e9);
  airfoil.footprint_upper = -airfoil.footprint_lower;
  for (const Strip& strip : strips)
    for (const double u : equally_spaced(0.0, 1.0, 50)) {
      const gp_Pnt point = strip.fillet->Value(u, 0.0);
      airfoil.footprint_lower = airfoil.footprint_lower.cwiseMin(Vec2(point.X(), point.Y()));
      airfoil.footprint_upper = airfoil.footprint_upper.cwiseMax(Vec2(point.X(), point.Y()));
    }
}

}  // namespace

BladeAirfoil blade_airfoil_faces(const TurbineBladeParameters& parameters) {
  const MeanLine mean_line = mean_line_of(parameters);
  // A radius that fits both ends fits between: it is linear along the span, and the radius of the section's
  // nose, which goes with thickness^2 / chord, is convex.
  BladeSection(mean_line, section_size_at(parameters, 0.0), "root");
  BladeSection(mean_line, section_size_at(parameters, parameters.span_mm), "tip");

  const auto stations_mm = equally_spaced(parameters.fillet_radius_mm, parameters.span_mm, kSectionIntervals);
  std::vector<BladeSection> sections;
  for (const double z_mm : stations_mm)
    sections.emplace_back(mean_line, section_size_at(parameters, z_mm), "root");

  BladeAirfoil airfoil;
  BRepBuilderAPI_MakeWire footprint, tip;
  std::vector<Strip> strips = strips_of(parameters);
  for (Strip& strip : strips) {
    strip.airfoil = airfoil_strip(strip, stations_mm, sections);
    strip.fillet = blade_fillet(strip.airfoil, strip.samples, parameters.fillet_radius_mm);
    add_patches(airfoil, strip, parameters, footprint, tip);
  }
  // Both wires run clockwise seen from +z: around a hole of the platform, and around a face that looks down,
  // which sewing turns over.
  airfoil.footprint = footprint.Wire();
  measure_footprint(airfoil, strips);
  const gp_Pln tip_plane(gp_Pnt(0, 0, parameters.span_mm), gp_Dir(0, 0, -1));
  airfoil.faces.push_back({"tip", BRepBuilderAPI_MakeFace(tip_plane, tip.Wire())});
  return airfoil;
}

}  // namespace trueblade
