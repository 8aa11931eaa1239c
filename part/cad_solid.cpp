#include "part/cad_solid.h"

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <stdexcept>

#include "geometry/error.h"

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
  // A solid that is itself reversed is right, but fillets on it are not.
  if (solid.Orientation() == TopAbs_REVERSED)
    solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(sewn.Reversed()));
  if (!BRepCheck_Analyzer(solid).IsValid())
    throw InputError("the parameters make no valid solid: its faces cross each other");

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

CadShape successor(const CadShape& solid, BRepBuilderAPI_MakeShape& operation, const std::string& new_name) {
  if (!operation.IsDone()) throw InputError("the " + new_name + "s do not fit the part");
  TopExp_Explorer solids(operation.Shape(), TopAbs_SOLID);
  if (!solids.More()) throw InputError("the " + new_name + "s leave nothing of the part");
  CadShape next{solids.Current(), {}, {}};
  solids.Next();
  if (solids.More()) throw InputError("the " + new_name + "s cut the part to pieces");
  if (!BRepCheck_Analyzer(next.shape).IsValid())
    throw InputError("the " + new_name + "s do not fit the part");

  TopTools_DataMapOfShapeInteger old_number;
  for (std::size_t i = 0; i < solid.faces.size(); ++i) {
    const TopTools_ListOfShape& heirs = operation.Modified(solid.faces[i]);
    for (const TopoDS_Shape& heir : heirs) old_number.Bind(heir, static_cast<int>(i));
    if (heirs.IsEmpty()) old_number.Bind(solid.faces[i], static_cast<int>(i));
  }
  struct Place {
    int old;
    TopoDS_Face face;
  };
  const int is_new = static_cast<int>(solid.faces.size());
  std::vector<Place> places;
  for (const TopoDS_Face& face : faces_of(next.shape))
    places.push_back({old_number.IsBound(face) ? old_number.Find(face) : is_new, face});
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.old < b.old; });
  int news = 0;
  for (const Place& place : places) {
    next.faces.push_back(place.face);
    next.names.push_back(place.old == is_new ? new_name + "_" + std::to_string(++news)
                                             : solid.names[static_cast<std::size_t>(place.old)]);
  }
  return next;
}

}  // namespace trueblade
