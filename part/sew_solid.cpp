#include "part/sew_solid.h"

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <stdexcept>

namespace trueblade {

CadShape sew_solid(const std::vector<NamedFace>& faces) {
  constexpr double kSewingTolerance_mm = 1e-6;  // common edges agree to rounding: 1e-14 of 100 mm
  BRepBuilderAPI_Sewing sewing(kSewingTolerance_mm);
  for (const NamedFace& each : faces) sewing.Add(each.face);
  sewing.Perform();
  const TopoDS_Shape sewn = sewing.SewedShape();
  if (sewn.IsNull() || sewn.ShapeType() != TopAbs_SHELL || sewing.NbFreeEdges() > 0)
    throw std::logic_error("sew_solid: the faces leave " + std::to_string(sewing.NbFreeEdges()) +
                           " free edges");
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(sewn));
  BRepLib::OrientClosedSolid(solid);
  if (!BRepCheck_Analyzer(solid).IsValid()) throw std::logic_error("sew_solid: the solid is not valid");

  CadShape cad{solid, {}, {}};
  TopTools_IndexedMapOfShape oriented;
  for (const TopoDS_Face& face : faces_of(solid)) oriented.Add(face);
  for (const NamedFace& each : faces) {
    const int at = oriented.FindIndex(sewing.Modified(each.face));
    if (at == 0) throw std::logic_error("sew_solid: lost the face " + each.name);
    cad.faces.push_back(TopoDS::Face(oriented(at)));
    cad.names.push_back(each.name);
  }
  return cad;
}

}  // namespace trueblade
