#include "inspection/surface_statistics.h"

namespace trueblade {

std::vector<SurfaceStatistics> statistics_by_surface(const Part& part, const Deviations& deviations,
                                                     const std::optional<Tolerance>& tolerance) {
  std::vector<std::vector<double>> signed_mm(part.surfaces.size()), from_facets_mm(part.surfaces.size());
  std::vector<std::vector<bool>> is_outlier(part.surfaces.size());
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    signed_mm[deviations.surface[i]].push_back(deviations.signed_mm[i]);
    from_facets_mm[deviations.surface[i]].push_back(deviations.from_facets_mm[i]);
    is_outlier[deviations.surface[i]].push_back(deviations.outliers.is_outlier[i]);
  }
  std::vector<SurfaceStatistics> measured;
  for (std::uint32_t s = 0; s < part.surfaces.size(); ++s) {
    if (signed_mm[s].empty()) continue;
    SurfaceStatistics& surface = measured.emplace_back();
    surface.surface = s;
    surface.name = part.surfaces[s].name;
    surface.statistics = statistics_of(signed_mm[s], is_outlier[s]);
    surface.from_facets = statistics_of(from_facets_mm[s], is_outlier[s]);
    if (tolerance) surface.tolerance = count_against(signed_mm[s], is_outlier[s], *tolerance);
  }
  return measured;
}

}  // namespace trueblade
