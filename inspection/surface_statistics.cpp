#include "inspection/surface_statistics.h"

namespace trueblade {

std::vector<SurfaceStatistics> statistics_by_surface(const Part& part, const Deviations& deviations,
                                                     const std::optional<Tolerance>& tolerance) {
  std::vector<std::vector<double>> signed_mm(part.surfaces.size());
  std::vector<std::vector<bool>> is_outlier(part.surfaces.size());
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    signed_mm[deviations.surface[i]].push_back(deviations.signed_mm[i]);
    is_outlier[deviations.surface[i]].push_back(deviations.outliers.is_outlier[i]);
  }
  std::vector<SurfaceStatistics> measured;
  for (std::uint32_t s = 0; s < part.surfaces.size(); ++s) {
    if (signed_mm[s].empty()) continue;
    measured.push_back({s, part.surfaces[s].name, statistics_of(signed_mm[s], is_outlier[s]), std::nullopt});
    if (tolerance) measured.back().tolerance = count_against(signed_mm[s], is_outlier[s], *tolerance);
  }
  return measured;
}

}  // namespace trueblade
