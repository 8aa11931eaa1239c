#include "part/assemble_part.h"

#include <Eigen/Geometry>

namespace trueblade {

Part assemble_part(const std::string& name, const FacetSoup& soup, std::vector<PartSurface> surfaces,
                   const std::vector<std::array<Vec2, 3>>& corner_parameters) {
  FacetModelBuild build = build_facet_model(soup, 0.0);
  Part part;
  part.name = name;
  part.model = std::move(build.model);
  part.report = build.report;
  part.surfaces = std::move(surfaces);
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    const auto [a, b, c] = part.model.corners_mm(facet);
    PartSurface& surface = part.surfaces[part.model.surface_of(facet)];
    ++surface.facets;
    surface.area_mm2 += 0.5 * (b - a).cross(c - a).norm();
  }
  if (!corner_parameters.empty())
    for (const std::uint32_t facet : build.soup_facet)
      part.facet_parameters.push_back(corner_parameters[facet]);
  return part;
}

}  // namespace trueblade
