#include "part/part_from_cad_facets.h"

#include "part/assemble_part.h"
#include "part/surfaces_around.h"

namespace trueblade {

Part part_from_cad_facets(const std::string& name, CadFacets cad) {
  const FacetSoup soup{std::move(cad.nodes_mm), std::move(cad.facets), std::move(cad.surface_of_facet)};
  Part part = assemble_part(name, soup, std::move(cad.surfaces), cad.corner_parameters);
  part.exact = std::move(cad.exact);
  part.surfaces_around = std::make_shared<const SurfacesAround>(part.model);
  part.chord_tolerance_mm = cad.chord_tolerance_mm;
  return part;
}

}  // namespace trueblade
