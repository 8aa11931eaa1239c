#include "part/part_from_cad_facets.h"

#include "part/assemble_part.h"

namespace trueblade {

Part part_from_cad_facets(const std::string& name, CadFacets cad) {
  const FacetSoup soup{std::move(cad.nodes_mm), std::move(cad.facets), std::move(cad.surface_of_facet)};
  Part part = assemble_part(name, soup, std::move(cad.surfaces), cad.corner_parameters);
  part.exact = std::move(cad.exact);
  part.chord_tolerance_mm = cad.chord_tolerance_mm;
  return part;
}

}  // namespace trueblade
