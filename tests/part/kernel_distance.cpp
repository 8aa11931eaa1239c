#include "tests/part/kernel_distance.h"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Pnt.hxx>

#include "part/cad_shape.h"

namespace trueblade {

std::vector<double> kernel_distances_mm(const std::filesystem::path& step_file,
                                        const std::vector<Vec3>& points_mm) {
  // The faces and not the solid, whose inside has no distance.
  BRep_Builder builder;
  TopoDS_Compound faces;
  builder.MakeCompound(faces);
  for (const TopoDS_Face& face : read_step_shape(step_file, 1e-3).faces) builder.Add(faces, face);
  std::vector<double> distances_mm;
  for (const Vec3& p : points_mm)
    distances_mm.push_back(
        BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(gp_Pnt(p.x(), p.y(), p.z())).Vertex(), faces)
            .Value());
  return distances_mm;
}

}  // namespace trueblade
