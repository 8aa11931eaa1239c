#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_InterfaceModel.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <sstream>

#include "geometry/error.h"
#include "part/cad_envelope.h"
#include "part/cad_guard.h"
#include "part/cad_process.h"
#include "part/cad_shape.h"
#include "part/input_file.h"
#include "part/loop_side.h"

namespace trueblade {

std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape seen;  // a face between two solids is met twice
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next())
    if (const int known = seen.Extent(); seen.Add(each.Current()) > known)
      faces.push_back(TopoDS::Face(each.Current()));
  return faces;
}

namespace {

std::string name_of(const Handle(Standard_Transient) & entity) {
  Handle(TCollection_HAsciiString) name;
  if (const auto step = Handle(StepRepr_RepresentationItem)::DownCast(entity); !step.IsNull()) {
    name = step->Name();
  } else if (const auto iges = Handle(IGESData_IGESEntity)::DownCast(entity); !iges.IsNull()) {
    name = iges->HasName() ? iges->NameValue() : nullptr;
  }
  return name.IsNull() ? std::string() : std::string(name->ToCString());
}

// The names that the file gives to the entities that became one face each.
std::vector<std::string> face_names(const XSControl_Reader& reader, const std::vector<TopoDS_Face>& faces) {
  TopTools_DataMapOfShapeInteger face_number;
  for (std::size_t i = 0; i < faces.size(); ++i)
    face_number.Bind(faces[i].Located(TopLoc_Location()), static_cast<int>(i));

  std::vector<std::string> names(faces.size());
  const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
  const Handle(Interface_InterfaceModel) model = reader.Model();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const std::string name = name_of(model->Value(i));
    if (name.empty()) continue;
    TopoDS_Shape shape = TransferBRep::ShapeResult(process, model->Value(i));
    if (shape.IsNull() || shape.ShapeType() != TopAbs_FACE) continue;
    shape.Location(TopLoc_Location());
    if (face_number.IsBound(shape)) names[static_cast<std::size_t>(face_number.Find(shape))] = name;
  }
  return names;
}

bool has_loose_faces(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_edge;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of_edge);
  for (int i = 1; i <= faces_of_edge.Extent(); ++i)
    if (faces_of_edge(i).Extent() == 1 && !BRep_Tool::Degenerated(TopoDS::Edge(faces_of_edge.FindKey(i))))
      return true;
  return false;
}

// Shells that sewing closed become solids, so that their faces look outward.
TopoDS_Shape with_closed_shells_as_solids(const TopoDS_Shape& sewn) {
  BRep_Builder builder;
  TopoDS_Compound parts;
  builder.MakeCompound(parts);
  for (TopExp_Explorer each(sewn, TopAbs_SHELL); each.More(); each.Next()) {
    const TopoDS_Shell shell = TopoDS::Shell(each.Current());
    if (BRep_Tool::IsClosed(shell)) {
      TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shell);
      BRepLib::OrientClosedSolid(solid);
      builder.Add(parts, solid);
    } else {
      builder.Add(parts, shell);
    }
  }
  for (TopExp_Explorer each(sewn, TopAbs_FACE, TopAbs_SHELL); each.More(); each.Next())
    builder.Add(parts, each.Current());
  return parts;
}

void sew(CadShape& cad, double tolerance_mm) {
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  for (const TopoDS_Face& face : cad.faces) sewing.Add(face);
  sewing.Perform();
  if (sewing.SewedShape().IsNull()) return;
  cad.shape = with_closed_shells_as_solids(sewing.SewedShape());

  TopTools_IndexedMapOfShape oriented;
  for (const TopoDS_Face& face : faces_of(cad.shape)) oriented.Add(face);
  CadShape sewn{cad.shape, {}, {}};
  for (std::size_t i = 0; i < cad.faces.size(); ++i) {
    const int at = oriented.FindIndex(sewing.Modified(cad.faces[i]));
    if (at == 0) continue;  // a face that sewing found to be without extent
    sewn.faces.push_back(TopoDS::Face(oriented(at)));
    sewn.names.push_back(cad.names[i]);
  }
  cad = sewn;
}

CadShape transferred(XSControl_Reader& reader) {
  reader.TransferRoots();
  CadShape cad;
  cad.shape = reader.OneShape();
  if (cad.shape.IsNull()) return cad;
  cad.faces = faces_of(cad.shape);
  cad.names = face_names(reader, cad.faces);
  return cad;
}

void require_faces(const CadShape& cad, const std::filesystem::path& file) {
  if (cad.faces.empty()) throw file_error(file.string(), "holds no solid and no surface");
}

CadShape read_guarded(const std::filesystem::path& file, const std::function<CadShape()>& read) {
  CadShape cad;
  with_cad_kernel(file, "read", [&] { cad = read_in_own_process(file, read); });
  return cad;
}

}  // namespace

CadShape read_step_shape(const std::filesystem::path& file, double sewing_tolerance_mm) {
  const std::string bytes = read_file_bytes(file);
  check_step_envelope(file, bytes);
  return read_guarded(file, [&] {
    STEPControl_Reader reader;
    std::istringstream stream(bytes);
    if (reader.ReadStream(file.filename().c_str(), stream) != IFSelect_RetDone)
      throw file_error(file.string(), "is not a STEP file that can be understood");
    CadShape cad = transferred(reader);
    require_faces(cad, file);
    if (has_loose_faces(cad.shape)) sew(cad, sewing_tolerance_mm);
    require_faces(cad, file);
    return cad;
  });
}

CadShape read_iges_shape(const std::filesystem::path& file, double sewing_tolerance_mm) {
  check_iges_envelope(file, read_file_bytes(file));
  return read_guarded(file, [&] {
    IGESControl_Reader reader;
    if (reader.ReadFile(file.c_str()) != IFSelect_RetDone)
      throw file_error(file.string(), "is not an IGES file that can be understood");
    CadShape cad = transferred(reader);
    require_faces(cad, file);
    choose_loop_sides(cad.faces, sewing_tolerance_mm);
    sew(cad, sewing_tolerance_mm);
    require_faces(cad, file);
    return cad;
  });
}

}  // namespace trueblade
