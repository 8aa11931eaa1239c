#include "part/reference_sphere.h"

#include "part/facet_cad_shape.h"
#include "part/part_from_cad_facets.h"
#include "part/reference_sphere_shape.h"
#include "part/require_parameter.h"

namespace trueblade {

void ReferenceSphereParameters::validate() const {
  require_within("diameter_mm", diameter_mm, 0.1, 1000.0);
}

Part make_reference_sphere(const ReferenceSphereParameters& parameters, const FacetingOptions& faceting) {
  parameters.validate();
  faceting.validate();
  return part_from_cad_facets(
      "reference_sphere",
      facet_cad_shape(build_reference_sphere(parameters.diameter_mm), "reference_sphere", faceting));
}

}  // namespace trueblade
