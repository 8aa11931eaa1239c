#include "part/chord_error.h"

#include <algorithm>
#include <array>

#include "geometry/parallel.h"

namespace trueblade {

namespace {

double chord_error_mm(const Part& part, std::uint32_t facet) {
  constexpr std::array<std::array<double, 3>, 4> kSamples{
      {{1.0 / 3, 1.0 / 3, 1.0 / 3}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}}};
  const auto corners_mm = part.model.corners_mm(facet);
  const auto& parameters = part.facet_parameters[facet];
  double largest = 0.0;
  for (const auto& weight : kSamples) {
    const Vec3 point_mm = weight[0] * corners_mm[0] + weight[1] * corners_mm[1] + weight[2] * corners_mm[2];
    const Vec2 start = weight[0] * parameters[0] + weight[1] * parameters[1] + weight[2] * parameters[2];
    const auto foot = part.exact->project(part.model.surface_of(facet), point_mm, start);
    if (foot.converged) largest = std::max(largest, foot.distance_mm);
  }
  return largest;
}

}  // namespace

std::optional<std::vector<double>> chord_errors_mm(const Part& part) {
  if (!part.exact) return std::nullopt;
  std::vector<double> of_facet(part.model.facet_count());
  constexpr std::size_t kBlock = 1024;
  parallel_for_blocks(of_facet.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t facet = begin; facet < end; ++facet)
      of_facet[facet] = chord_error_mm(part, static_cast<std::uint32_t>(facet));
  });
  std::vector<double> of_surface(part.surfaces.size(), 0.0);
  for (std::uint32_t facet = 0; facet < of_facet.size(); ++facet) {
    double& largest = of_surface[part.model.surface_of(facet)];
    largest = std::max(largest, of_facet[facet]);
  }
  return of_surface;
}

}  // namespace trueblade
