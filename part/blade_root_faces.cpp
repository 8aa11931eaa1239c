#include "part/blade_root_faces.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <TopoDS.hxx>
#include <gp_Pln.hxx>
#include <gp_Vec.hxx>

#include "part/fir_tree.h"

namespace trueblade {

namespace {

TopoDS_Wire polygon(const std::vector<gp_Pnt>& corners) {
  BRepBuilderAPI_MakePolygon wire;
  for (const gp_Pnt& corner : corners) wire.Add(corner);
  wire.Close();
  return wire.Wire();
}

// Counter-clockwise seen from +z.
TopoDS_Wire rectangle(double half_length, double half_width, double z) {
  return polygon({{-half_length, -half_width, z},
                  {half_length, -half_width, z},
                  {half_length, half_width, z},
                  {-half_length, half_width, z}});
}

TopoDS_Face horizontal_face(double z, const TopoDS_Wire& outer, const TopoDS_Wire& hole) {
  BRepBuilderAPI_MakeFace face(gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), outer);
  face.Add(hole);
  return face.Face();
}

void add_platform(std::vector<NamedFace>& faces, const TurbineBladeParameters& p,
                  const TopoDS_Wire& footprint, double root_half_width) {
  const double length = 0.5 * p.platform_length_mm, width = 0.5 * p.platform_width_mm;
  const double underside = -p.platform_thickness_mm;
  faces.push_back({"platform_top", horizontal_face(0.0, rectangle(length, width, 0.0), footprint)});
  const auto side = [&](const char* name, double x1, double y1, double x2, double y2) {
    const TopoDS_Wire wire =
        polygon({{x1, y1, underside}, {x2, y2, underside}, {x2, y2, 0.0}, {x1, y1, 0.0}});
    faces.push_back({name, BRepBuilderAPI_MakeFace(wire, Standard_True)});
  };
  side("platform_front", -length, -width, -length, width);
  side("platform_back", length, -width, length, width);
  side("platform_suction", -length, width, length, width);
  side("platform_pressure", -length, -width, length, -width);
  const TopoDS_Wire neck = rectangle(0.5 * p.root_length_mm, root_half_width, underside);
  faces.push_back({"platform_underside", horizontal_face(underside, rectangle(length, width, underside),
                                                         TopoDS::Wire(neck.Reversed()))});
}

TopoDS_Edge edge_of(const OutlinePiece& piece, double x) {
  const auto at = [&](const Vec2& p) { return gp_Pnt(x, p.x(), p.y()); };
  if (piece.is_arc)
    return BRepBuilderAPI_MakeEdge(
        GC_MakeArcOfCircle(at(piece.first), at(piece.middle), at(piece.last)).Value());
  return BRepBuilderAPI_MakeEdge(at(piece.first), at(piece.last));
}

TopoDS_Face end_face(const std::vector<OutlinePiece>& outline, double x) {
  BRepBuilderAPI_MakeWire wire;
  for (const OutlinePiece& piece : outline) wire.Add(edge_of(piece, x));
  wire.Add(edge_of({"", outline.back().last, {}, outline.front().first, false}, x));
  return BRepBuilderAPI_MakeFace(wire.Wire(), Standard_True);
}

}  // namespace

std::vector<NamedFace> blade_root_faces(const TurbineBladeParameters& parameters,
                                        const TopoDS_Wire& footprint) {
  const std::vector<OutlinePiece> outline = fir_tree_outline(parameters);
  const double front = -0.5 * parameters.root_length_mm, back = 0.5 * parameters.root_length_mm;
  std::vector<NamedFace> faces;
  add_platform(faces, parameters, footprint, outline.front().first.x());
  for (const OutlinePiece& piece : outline) {
    const TopoDS_Shape swept = BRepPrimAPI_MakePrism(edge_of(piece, front), gp_Vec(back - front, 0, 0));
    faces.push_back({piece.name, TopoDS::Face(swept)});
  }
  faces.push_back({"root_front", end_face(outline, front)});
  faces.push_back({"root_back", end_face(outline, back)});
  return faces;
}

}  // namespace trueblade
