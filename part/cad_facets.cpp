#include "part/cad_facets.h"

#include "part/cad_shape.h"
#include "part/facet_cad_shape.h"

namespace trueblade {

CadFacets read_cad_facets(const std::filesystem::path& file, CadFormat format,
                          const FacetingOptions& faceting) {
  faceting.validate();
  // A gap that the chord tolerance would hide between two facets is no gap.
  const double sewing_tolerance_mm = faceting.chord_tolerance_mm;
  const CadShape cad = format == CadFormat::step ? read_step_shape(file, sewing_tolerance_mm)
                                                 : read_iges_shape(file, sewing_tolerance_mm);
  return facet_cad_shape(cad, file, faceting);
}

}  // namespace trueblade
