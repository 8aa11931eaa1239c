#include "part/loop_side.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_Surface.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <ShapeFix_Face.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <optional>

namespace trueblade {

namespace {

struct EdgeMiddle {
  gp_Pnt point;
  std::size_t face;
};

std::vector<EdgeMiddle> edge_middles(const std::vector<TopoDS_Face>& faces) {
  std::vector<EdgeMiddle> middles;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (TopExp_Explorer each(faces[i], TopAbs_EDGE); each.More(); each.Next()) {
      double first = 0.0, last = 0.0;
      const Handle(Geom_Curve) curve = BRep_Tool::Curve(TopoDS::Edge(each.Current()), first, last);
      if (!curve.IsNull()) middles.push_back({curve->Value(0.5 * (first + last)), i});
    }
  return middles;
}

// Closed around and drawn together to a point at both ends, like a sphere.
bool has_no_border(const TopoDS_Face& face, double tolerance_mm) {
  ShapeAnalysis_Surface surface(BRep_Tool::Surface(face));
  return surface.NbSingularities(tolerance_mm) == 2 &&
         (surface.IsUClosed(tolerance_mm) || surface.IsVClosed(tolerance_mm));
}

bool contains_middle_of_other_edge(const TopoDS_Face& face, std::size_t number,
                                   const std::vector<EdgeMiddle>& middles, double tolerance_mm) {
  const Handle(Geom_Surface) geometry = BRep_Tool::Surface(face);
  ShapeAnalysis_Surface surface(geometry);
  const GeomAdaptor_Surface adaptor(geometry);
  BRepTopAdaptor_FClass2d region(
      face, std::max(adaptor.UResolution(tolerance_mm), adaptor.VResolution(tolerance_mm)));
  Bnd_Box box;
  BRepBndLib::Add(face, box);
  box.Enlarge(tolerance_mm);
  return std::any_of(middles.begin(), middles.end(), [&](const EdgeMiddle& middle) {
    if (middle.face == number || box.IsOut(middle.point)) return false;
    const gp_Pnt2d uv = surface.ValueOfUV(middle.point, tolerance_mm);
    if (surface.Value(uv).Distance(middle.point) > tolerance_mm) return false;
    return region.Perform(uv, /*RecadreOnPeriodic=*/Standard_True) == TopAbs_IN;
  });
}

// The loop run the other way round. Its curves on the surface and the poles it passes are found anew, since
// both depend on the side. nullopt for faces of several loops and for loops that follow a seam.
std::optional<TopoDS_Face> other_side_of(const TopoDS_Face& face) {
  TopExp_Explorer loops(face, TopAbs_WIRE);
  if (!loops.More()) return std::nullopt;
  loops.Next();
  if (loops.More()) return std::nullopt;

  std::vector<TopoDS_Edge> edges;
  for (BRepTools_WireExplorer each(BRepTools::OuterWire(face), face); each.More(); each.Next()) {
    const TopoDS_Edge& edge = each.Current();
    if (BRep_Tool::Degenerated(edge)) continue;
    double first = 0.0, last = 0.0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
    if (curve.IsNull() || BRep_Tool::IsClosed(edge, face)) return std::nullopt;
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const TopoDS_Edge copy = BRepBuilderAPI_MakeEdge(curve, TopExp::FirstVertex(forward),
                                                     TopExp::LastVertex(forward), first, last);
    edges.push_back(TopoDS::Edge(copy.Oriented(edge.Orientation()).Reversed()));
  }
  BRep_Builder builder;
  TopoDS_Wire loop;
  builder.MakeWire(loop);
  for (auto edge = edges.rbegin(); edge != edges.rend(); ++edge) builder.Add(loop, *edge);
  loop.Closed(true);
  TopoDS_Face other;
  builder.MakeFace(other, BRep_Tool::Surface(face), BRep_Tool::Tolerance(face));
  builder.Add(other, loop);
  ShapeFix_Face fix(other);
  fix.Perform();
  return fix.Face();
}

}  // namespace

void choose_loop_sides(std::vector<TopoDS_Face>& faces, double tolerance_mm) {
  const std::vector<EdgeMiddle> middles = edge_middles(faces);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!has_no_border(faces[i], tolerance_mm)) continue;
    if (!contains_middle_of_other_edge(faces[i], i, middles, tolerance_mm)) continue;
    const auto other = other_side_of(faces[i]);
    if (other && !contains_middle_of_other_edge(*other, i, middles, tolerance_mm)) faces[i] = *other;
  }
}

}  // namespace trueblade
