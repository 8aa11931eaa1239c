#include "part/write_step_shape.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <STEPConstruct.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>

#include "geometry/atomic_file.h"
#include "part/cad_guard.h"

namespace trueblade {

namespace {

Handle(TCollection_HAsciiString) text(const std::string& value) {
  return new TCollection_HAsciiString(value.c_str());
}

void name_faces(const STEPControl_Writer& writer, const CadShape& cad) {
  const Handle(Transfer_FinderProcess) process = writer.WS()->TransferWriter()->FinderProcess();
  for (std::size_t i = 0; i < cad.faces.size(); ++i)
    if (const auto item = STEPConstruct::FindEntity(process, cad.faces[i]); !item.IsNull())
      item->SetName(text(cad.names[i]));
}

// The writer numbers the products of one process; the same part shall have the same name every time.
void name_product(const STEPControl_Writer& writer, const std::string& product) {
  const Handle(Interface_InterfaceModel) model = writer.WS()->Model();
  for (int i = 1; i <= model->NbEntities(); ++i)
    if (const auto entity = Handle(StepBasic_Product)::DownCast(model->Value(i)); !entity.IsNull()) {
      entity->SetId(text(product));
      entity->SetName(text(product));
    }
}

void write_header(const STEPControl_Writer& writer, const std::string& product) {
  APIHeaderSection_MakeHeader header(Handle(StepData_StepModel)::DownCast(writer.WS()->Model()));
  header.SetName(text(product));
  header.SetTimeStamp(text("1970-01-01T00:00:00"));
  header.SetAuthorValue(1, text(""));
  header.SetOrganizationValue(1, text(""));
  header.SetPreprocessorVersion(text("Open CASCADE"));
  header.SetOriginatingSystem(text("trueblade"));
}

}  // namespace

void write_step_shape(const CadShape& cad, const std::string& product,
                      const std::filesystem::path& step_file) {
  // Through our own stream, which says why when it cannot write; the kernel's writer of files does not.
  write_file_atomically(step_file, [&](std::ostream& out) {
    with_cad_kernel(step_file, "written", [&] {
      STEPControl_Writer writer;
      Interface_Static::SetCVal("write.step.schema", "AP214IS");
      Interface_Static::SetCVal("write.step.unit", "MM");
      writer.Transfer(cad.shape, STEPControl_ManifoldSolidBrep);
      name_product(writer, product);
      name_faces(writer, cad);
      write_header(writer, product);
      StepData_StepWriter lines(Handle(StepData_StepModel)::DownCast(writer.WS()->Model()));
      lines.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
      lines.Print(out);
    });
  });
}

}  // namespace trueblade
