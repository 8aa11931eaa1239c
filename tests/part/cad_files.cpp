#include "tests/part/cad_files.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "part/cad_guard.h"

namespace trueblade {
namespace {

TopoDS_Shape box() {
  return BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape();
}

TopoDS_Shape spline_patch() {
  TColgp_Array2OfPnt points(1, 21, 1, 16);
  for (int i = 1; i <= 21; ++i)
    for (int j = 1; j <= 16; ++j) {
      const double x = 2.0 * (i - 1), y = 2.0 * (j - 1);
      points(i, j) = gp_Pnt(x, y, 3.0 * std::sin(x / 10) * std::cos(y / 8));
    }
  GeomAPI_PointsToBSplineSurface interpolation;
  interpolation.Interpolate(points);
  return BRepBuilderAPI_MakeFace(interpolation.Surface(), 1e-6).Shape();
}

TopoDS_Shape filleted_box() {
  const TopoDS_Shape sharp = box();
  BRepFilletAPI_MakeFillet fillet(sharp);
  for (TopExp_Explorer each(sharp, TopAbs_EDGE); each.More(); each.Next())
    fillet.Add(2.0, TopoDS::Edge(each.Current()));
  return fillet.Shape();
}

TopoDS_Shape two_boxes() {
  gp_Trsf moved;
  moved.SetTranslation(gp_Vec(50, 0, 0));
  TopoDS_Compound both;
  BRep_Builder builder;
  builder.MakeCompound(both);
  builder.Add(both, box());
  builder.Add(both, BRepBuilderAPI_Transform(box(), moved, true).Shape());
  return both;
}

TopoDS_Shape build(TestShape shape) {
  switch (shape) {
    case TestShape::box:
      return box();
    case TestShape::sphere:
      return BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 8.0).Shape();
    case TestShape::cylinder:
      return BRepPrimAPI_MakeCylinder(5.0, 12.0).Shape();
    case TestShape::torus:
      return BRepPrimAPI_MakeTorus(10.0, 3.0).Shape();
    case TestShape::spline_patch:
      return spline_patch();
    case TestShape::filleted_box:
      return filleted_box();
    case TestShape::two_boxes:
      return two_boxes();
    case TestShape::wire:
      break;
  }
  return BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0)).Shape();
}

}  // namespace

void write_test_shape(TestShape shape, const std::filesystem::path& file, const std::string& unit) {
  bool written = false;
  with_cad_kernel(file, "written", [&] {
    const TopoDS_Shape built = build(shape);
    if (file.extension() == ".igs") {
      IGESControl_Controller::Init();
      IGESControl_Writer writer(unit.c_str(), 1);  // 1: as solids and shells where there are some
      writer.AddShape(built);
      writer.ComputeModel();
      written = writer.Write(file.c_str());
      return;
    }
    STEPControl_Controller::Init();
    Interface_Static::SetCVal("write.step.unit", unit.c_str());
    STEPControl_Writer writer;
    writer.Transfer(built, shape == TestShape::wire ? STEPControl_GeometricCurveSet : STEPControl_AsIs);
    written = writer.Write(file.c_str()) == IFSelect_RetDone;
    Interface_Static::SetCVal("write.step.unit", "MM");
  });
  if (!written) throw std::runtime_error("the test shape was not written");
}

}  // namespace trueblade
