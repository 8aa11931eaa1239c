#include "tests/registration/moved_blade.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <TopoDS.hxx>
#include <gp_Trsf.hxx>
#include <gp_Vec.hxx>

#include "part/facet_cad_shape.h"
#include "part/part_from_cad_facets.h"
#include "part/turbine_blade_shape.h"

namespace trueblade {

Part moved_turbine_blade(const Vec3& translation_mm, const FacetingOptions& faceting) {
  CadShape blade = build_turbine_blade(TurbineBladeParameters{});
  gp_Trsf translation;
  translation.SetTranslation(gp_Vec(translation_mm.x(), translation_mm.y(), translation_mm.z()));
  constexpr bool kOwnGeometry = true;
  BRepBuilderAPI_Transform moved(blade.shape, translation, kOwnGeometry);
  blade.shape = moved.Shape();
  for (TopoDS_Face& face : blade.faces) face = TopoDS::Face(moved.ModifiedShape(face));
  return part_from_cad_facets("moved_turbine_blade", facet_cad_shape(blade, "moved_turbine_blade", faceting));
}

}  // namespace trueblade
