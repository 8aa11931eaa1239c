#include "part/reference_sphere_shape.h"

#include <BRepPrimAPI_MakeSphere.hxx>

namespace trueblade {

CadShape build_reference_sphere(double diameter_mm) {
  CadShape cad;
  cad.shape = BRepPrimAPI_MakeSphere(0.5 * diameter_mm).Shape();
  cad.faces = faces_of(cad.shape);
  cad.names.assign(cad.faces.size(), "sphere");
  return cad;
}

}  // namespace trueblade
