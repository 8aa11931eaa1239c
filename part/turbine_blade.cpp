#include "part/turbine_blade.h"

#include "part/facet_cad_shape.h"
#include "part/part_from_cad_facets.h"
#include "part/turbine_blade_shape.h"
#include "part/write_step_shape.h"

namespace trueblade {

void write_turbine_blade(const TurbineBladeParameters& parameters, const std::filesystem::path& step_file) {
  write_step_shape(build_turbine_blade(parameters), "turbine_blade", step_file);
}

Part make_turbine_blade(const TurbineBladeParameters& parameters, const FacetingOptions& faceting) {
  faceting.validate();
  return part_from_cad_facets("turbine_blade",
                              facet_cad_shape(build_turbine_blade(parameters), "turbine_blade", faceting));
}

}  // namespace trueblade
