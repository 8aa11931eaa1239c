#include "apps/evaluate_view.h"

#include <chrono>

#include "inspection/datum_fit.h"
#include "inspection/surface_statistics.h"

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

}  // namespace

EvaluatedView evaluate_view(const RegistrationTarget& target, const std::string& name, const ScanPoints& scan,
                            const RigidTransform& initial_part_from_mcs, const ViewEvaluationOptions& options,
                            const std::optional<RigidTransform>& true_part_from_mcs) {
  EvaluatedView view;
  view.result.view = name;

  const auto register_start = std::chrono::steady_clock::now();
  view.result.registration =
      register_to_datum(target, scan, initial_part_from_mcs, options.registration, options.datum_surfaces);
  view.result.time.register_s = seconds_since(register_start);

  const auto evaluate_start = std::chrono::steady_clock::now();
  const RigidTransform& part_from_mcs = view.result.registration.part_from_mcs;
  view.deviations = evaluate_deviations(target.part(), target.tree(), target.pseudo_normals(), scan,
                                        part_from_mcs, {options.surface});
  const std::vector<bool>& is_outlier = view.deviations.outliers.is_outlier;
  view.result.statistics = statistics_of(view.deviations.signed_mm, is_outlier);
  view.result.from_facets = statistics_of(view.deviations.from_facets_mm, is_outlier);
  if (options.tolerance)
    view.result.tolerance = count_against(view.deviations.signed_mm, is_outlier, *options.tolerance);
  view.result.surfaces = statistics_by_surface(target.part(), view.deviations, options.tolerance);
  view.result.initial_rms_mm = rms_distance_mm(target.tree(), scan.position_mcs_mm, initial_part_from_mcs);
  view.result.time.evaluate_s = seconds_since(evaluate_start);

  if (true_part_from_mcs)
    view.result.truth = pose_error(part_from_mcs, *true_part_from_mcs, centroid(scan.position_mcs_mm));
  return view;
}

}  // namespace trueblade
