#include "apps/evaluate_view.h"

#include <chrono>

#include "registration/register_scan.h"

namespace trueblade {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Vec3 centroid(const std::vector<Vec3>& points_mm) {
  Vec3 sum_mm = Vec3::Zero();
  for (const Vec3& point_mm : points_mm) sum_mm += point_mm;
  return sum_mm / static_cast<double>(points_mm.size());
}

std::vector<SurfaceStatistics> statistics_by_surface(const Part& part, const Deviations& deviations) {
  std::vector<std::vector<double>> signed_mm(part.surfaces.size());
  std::vector<std::vector<bool>> is_outlier(part.surfaces.size());
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    signed_mm[deviations.surface[i]].push_back(deviations.signed_mm[i]);
    is_outlier[deviations.surface[i]].push_back(deviations.outliers.is_outlier[i]);
  }
  std::vector<SurfaceStatistics> result;
  for (std::uint32_t surface = 0; surface < part.surfaces.size(); ++surface)
    if (!signed_mm[surface].empty())
      result.push_back(
          {surface, part.surfaces[surface].name, statistics_of(signed_mm[surface], is_outlier[surface])});
  return result;
}

}  // namespace

EvaluatedView evaluate_view(const RegistrationTarget& target, const std::string& name, const ScanPoints& scan,
                            const RigidTransform& initial_part_from_mcs, const RegistrationOptions& options,
                            DeviationSurface surface,
                            const std::optional<RigidTransform>& true_part_from_mcs) {
  EvaluatedView view;
  view.result.view = name;

  const auto register_start = std::chrono::steady_clock::now();
  view.result.registration = register_scan(target, scan, initial_part_from_mcs, options);
  view.result.time.register_s = seconds_since(register_start);

  const auto evaluate_start = std::chrono::steady_clock::now();
  const RigidTransform& part_from_mcs = view.result.registration.part_from_mcs;
  view.deviations = evaluate_deviations(target.part(), target.tree(), target.pseudo_normals(), scan,
                                        part_from_mcs, {surface});
  view.result.statistics = statistics_of(view.deviations.signed_mm, view.deviations.outliers.is_outlier);
  view.result.surfaces = statistics_by_surface(target.part(), view.deviations);
  view.result.time.evaluate_s = seconds_since(evaluate_start);

  if (true_part_from_mcs)
    view.result.truth = pose_error(part_from_mcs, *true_part_from_mcs, centroid(scan.position_mcs_mm));
  return view;
}

}  // namespace trueblade
