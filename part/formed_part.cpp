#include "part/formed_part.h"

#include "part/facet_cad_shape.h"
#include "part/formed_part_shape.h"
#include "part/part_from_cad_facets.h"
#include "part/write_step_shape.h"

namespace trueblade {

void write_formed_part(const FormedPartParameters& parameters, const std::filesystem::path& step_file) {
  write_step_shape(build_formed_part(parameters), "formed_part", step_file);
}

Part make_formed_part(const FormedPartParameters& parameters, const FacetingOptions& faceting) {
  faceting.validate();
  return part_from_cad_facets("formed_part",
                              facet_cad_shape(build_formed_part(parameters), "formed_part", faceting));
}

}  // namespace trueblade
