#include "part/formed_part_shape.h"

#include <fmt/core.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <array>
#include <cmath>
#include <gp_Ax2.hxx>

#include "part/cad_guard.h"
#include "part/cad_solid.h"
#include "part/cad_spline.h"
#include "part/forming.h"

namespace trueblade {

namespace {

// Both skins of the sheet, over the same parameters: u across, v along.
struct Skins {
  Handle(Geom_BSplineSurface) outer, inner;
};

// Cubic splines through points at most 2 mm apart, a third of the ramps and bends.
Skins press(const Forming& forming, const FormedPartParameters& p) {
  constexpr double kSpacing_mm = 2.0;
  const double from = forming.across_borders().front(), to = forming.across_borders().back();
  const auto across = equally_spaced(from, to, static_cast<int>(std::ceil((to - from) / kSpacing_mm)));
  const auto along = equally_spaced(-1.0, 1.0, static_cast<int>(std::ceil(p.length_mm / kSpacing_mm)));
  std::vector<std::vector<Vec3>> outer, inner;
  std::vector<double> flat_knots;
  for (const double v : along) {
    std::vector<Vec3> outer_points, inner_points;
    for (const double u : across) {
      outer_points.push_back(forming.point(u, v));
      inner_points.push_back(outer_points.back() - p.thickness_mm * forming.normal(u, v));
    }
    const CubicSpline outer_curve = not_a_knot_spline(across, outer_points);
    flat_knots = outer_curve.flat_knots;
    outer.push_back(outer_curve.poles);
    inner.push_back(not_a_knot_spline(across, inner_points).poles);
  }
  return {skin(flat_knots, along, outer), skin(flat_knots, along, inner)};
}

// The strip between the rims of both skins along one side of the sheet, ruled across: first to last parameter
// of the rim, as one cubic from outer to inner rim.
Handle(Geom_BSplineSurface)
    rim_strip(const Handle(Geom_BSplineCurve) & outer, const Handle(Geom_BSplineCurve) & inner) {
  std::vector<std::vector<Vec3>> rows(4);
  for (int i = 1; i <= outer->NbPoles(); ++i)
    for (int row = 0; row < 4; ++row)
      rows[static_cast<std::size_t>(row)].push_back(
          ((3 - row) * from_gp(outer->Pole(i).XYZ()) + row * from_gp(inner->Pole(i).XYZ())) / 3.0);
  std::vector<double> flat_knots;
  for (const double knot : outer->KnotSequence()) flat_knots.push_back(knot);
  return surface_of(flat_knots, {0, 0, 0, 0, 1, 1, 1, 1}, rows);
}

std::vector<NamedFace> sheet_faces(const Skins& skins, const std::vector<double>& across,
                                   const std::vector<double>& along) {
  std::vector<NamedFace> faces;
  const auto add = [&](const std::string& name, const Handle(Geom_BSplineSurface) & patch) {
    faces.push_back({name, BRepBuilderAPI_MakeFace(patch, Precision::Confusion())});
  };
  constexpr std::array kRegions = {"front_flange", "front_bend", "panel_front", "panel_middle",
                                   "panel_back",   "back_bend",  "back_flange"};
  const auto curve = [](const Handle(Geom_Curve) & iso) { return Handle(Geom_BSplineCurve)::DownCast(iso); };
  for (const auto& [skin_name, skin] : {std::pair{"outer", skins.outer}, std::pair{"inner", skins.inner}})
    for (std::size_t i = 0; i + 1 < across.size(); ++i)
      for (std::size_t j = 0; j + 1 < along.size(); ++j)
        add(fmt::format("{}_{}_{}", skin_name, kRegions[i], j + 1),
            patch_of(skin, across[i], across[i + 1], along[j], along[j + 1]));
  for (const auto& [side, v] : {std::pair{"left", along.front()}, std::pair{"right", along.back()}}) {
    const auto strip = rim_strip(curve(skins.outer->VIso(v)), curve(skins.inner->VIso(v)));
    for (std::size_t i = 0; i + 1 < across.size(); ++i)
      add(fmt::format("rim_{}_{}", side, kRegions[i]), patch_of(strip, across[i], across[i + 1], 0.0, 1.0));
  }
  for (const auto& [side, u] : {std::pair{"front", across.front()}, std::pair{"back", across.back()}}) {
    const auto strip = rim_strip(curve(skins.outer->UIso(u)), curve(skins.inner->UIso(u)));
    for (std::size_t j = 0; j + 1 < along.size(); ++j)
      add(fmt::format("rim_{}_{}", side, j + 1), patch_of(strip, along[j], along[j + 1], 0.0, 1.0));
  }
  return faces;
}

// The edges across the sheet's thickness at its four corners.
std::vector<TopoDS_Edge> corner_edges(const CadShape& sheet, const Skins& skins) {
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(sheet.shape, TopAbs_EDGE, edges);
  double u1, u2, v1, v2;
  skins.outer->Bounds(u1, u2, v1, v2);
  std::vector<TopoDS_Edge> corners;
  for (const auto& [u, v] : {std::pair{u1, v1}, std::pair{u1, v2}, std::pair{u2, v1}, std::pair{u2, v2}}) {
    const gp_Pnt outer = skins.outer->Value(u, v), inner = skins.inner->Value(u, v);
    for (int i = 1; i <= edges.Extent(); ++i) {
      const TopoDS_Edge edge = TopoDS::Edge(edges(i));
      const gp_Pnt a = BRep_Tool::Pnt(TopExp::FirstVertex(edge)),
                   b = BRep_Tool::Pnt(TopExp::LastVertex(edge));
      const auto joins = [](const gp_Pnt& p, const gp_Pnt& q, const gp_Pnt& r, const gp_Pnt& s) {
        return p.IsEqual(r, 1e-6) && q.IsEqual(s, 1e-6);
      };
      if (joins(a, b, outer, inner) || joins(b, a, outer, inner)) corners.push_back(edge);
    }
  }
  return corners;
}

CadShape with_round_corners(const CadShape& sheet, const std::vector<TopoDS_Edge>& corners,
                            double radius_mm) {
  BRepFilletAPI_MakeFillet fillet(sheet.shape);
  for (const TopoDS_Edge& edge : corners) fillet.Add(radius_mm, edge);
  fillet.Build();
  return successor(sheet, fillet, "corner");
}

// Holes pierced along the sheet's normal.
CadShape with_holes(const CadShape& sheet, const Forming& forming, const FormedPartParameters& p) {
  TopTools_ListOfShape body, tools;
  body.Append(sheet.shape);
  for (const Vec2& centre : forming.hole_centres()) {
    const Vec3 normal = forming.normal(centre.x(), centre.y());
    const double reach = p.hole_diameter_mm;  // beyond both skins, whose curvature is far smaller
    const Vec3 start = forming.point(centre.x(), centre.y()) - (p.thickness_mm + reach) * normal;
    tools.Append(BRepPrimAPI_MakeCylinder(gp_Ax2(to_gp(start), gp_Dir(normal.x(), normal.y(), normal.z())),
                                          0.5 * p.hole_diameter_mm, p.thickness_mm + 2.0 * reach)
                     .Shape());
  }
  BRepAlgoAPI_Cut cut;
  cut.SetArguments(body);
  cut.SetTools(tools);
  cut.Build();
  return successor(sheet, cut, "hole");
}

}  // namespace

CadShape build_formed_part(const FormedPartParameters& parameters) {
  parameters.validate();
  CadShape part;
  with_cad_kernel("formed_part", "built", [&] {
    const Forming forming(parameters);
    const Skins skins = press(forming, parameters);
    part = sew_solid(sheet_faces(skins, forming.across_borders(),
                                 equally_spaced(-1.0, 1.0, parameters.lengthwise_patches)));
    part = with_round_corners(part, corner_edges(part, skins), parameters.corner_radius_mm);
    part = with_holes(part, forming, parameters);
  });
  return part;
}

}  // namespace trueblade
