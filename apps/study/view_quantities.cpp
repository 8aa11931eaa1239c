#include "apps/study/view_quantities.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "apps/deviation_error.h"
#include "apps/study/pose_bound.h"
#include "inspection/deviations.h"
#include "inspection/result.h"
#include "inspection/surface_selection.h"

namespace trueblade {
namespace {

constexpr std::array<const char*, 6> kPoseComponents{"rotation_x",    "rotation_y",    "rotation_z",
                                                     "translation_x", "translation_y", "translation_z"};

constexpr std::array<const char*, 5> kAlwaysKept{"error_", "u_", "bound_", "reported_correlation_",
                                                 "surface_"};

const char* pose_unit(std::size_t component) {
  return component < 3 ? "rad" : "mm";
}

void add_pose_components(const std::string& stem, const std::string& description,
                         std::vector<Quantity>& list) {
  for (std::size_t k = 0; k < 6; ++k)
    list.push_back({fmt::format("{}_{}_{}", stem, kPoseComponents[k], pose_unit(k)), pose_unit(k),
                    description + (k < 3 ? " (about the axes of the part)" : " (of the scan centroid)")});
}

// Signed deviations as the report gives them.
struct ReportedDeviations {
  Deviations deviations;
  DeviationStatistics statistics;
};

ReportedDeviations report(const RegistrationTarget& target, const Scenario& scenario, const ScanPoints& scan,
                          const RigidTransform& part_from_mcs) {
  ReportedDeviations reported;
  reported.deviations = evaluate_deviations(target.part(), target.tree(), target.pseudo_normals(), scan,
                                            part_from_mcs, {scenario.inspection.surface});
  reported.statistics = statistics_of(reported.deviations.signed_mm, reported.deviations.outliers.is_outlier);
  return reported;
}

}  // namespace

SelectedSurfaces selected_surfaces(const StudySpec& study, const Part& part) {
  const auto select = [&](const SurfaceTexts& named, const std::string& key) {
    std::vector<std::uint32_t> surfaces;
    for (const std::string& text : named.texts) {
      try {
        for (const std::uint32_t surface : select_surfaces(part, {&text, 1}))
          if (std::find(surfaces.begin(), surfaces.end(), surface) == surfaces.end())
            surfaces.push_back(surface);
      } catch (const InputError& failure) {
        throw file_error(named.place, fmt::format("{}: {}", key, failure.what()));
      }
    }
    return surfaces;
  };
  SelectedSurfaces selected{select(study.surfaces, "surfaces"), {}};
  for (const ProfileQuantity& profile : study.profiles)
    selected.profiles.push_back(
        {profile.name, select(profile.surfaces, fmt::format("profile {}", profile.name))});
  return selected;
}

std::vector<Quantity> view_quantities(const SelectedSurfaces& selected) {
  std::vector<Quantity> list;
  add_pose_components("error", "pose error", list);
  list.push_back({"rotation_error_rad", "rad", "angle between registered and true pose"});
  list.push_back({"translation_error_mm", "mm", "displacement of the scan centroid by the pose error"});
  list.push_back({"points", "1", "usable points"});
  list.push_back({"initial_rms_mm", "mm", "RMS distance at the preliminary pose"});
  list.push_back({"rms_mm", "mm", "reported RMS of the signed deviations, report outliers left out"});
  list.push_back({"min_mm", "mm", "reported least signed deviation"});
  list.push_back({"max_mm", "mm", "reported largest signed deviation"});
  list.push_back({"iterations", "1", "iterations of the registration"});
  list.push_back({"inliers", "1", "points that took part in the last iteration"});
  add_pose_components("u", "standard uncertainty that the registration reports", list);
  for (const char* pair : {"xy", "xz", "yz"})
    list.push_back({fmt::format("reported_correlation_translation_{}", pair), "1",
                    "correlation of the translation, as the registration reports it"});
  list.push_back({"normalised_error_squared", "1",
                  "pose error in the metric of its reported covariance; chi-square of 6 when it is right"});
  add_pose_components("bound", "Cramer-Rao bound of the standard deviation for the sensor's noise", list);
  list.push_back(
      {"deviation_error_rms_mm", "mm", "reported minus true deviation of every point, RMS over the points"});
  list.push_back({"deviation_error_largest_mm", "mm", "the same of one point, largest by size, signed"});
  for (const std::uint32_t surface : selected.surfaces) {
    list.push_back({fmt::format("surface_{}_mean_error_mm", surface), "mm",
                    "reported minus true deviation, mean over the surface's points"});
    list.push_back({fmt::format("surface_{}_largest_error_mm", surface), "mm",
                    "the same of one point, largest by size, signed"});
  }
  return list;
}

bool is_always_kept(const std::string& view_quantity) {
  if (view_quantity == "normalised_error_squared") return true;
  return std::any_of(kAlwaysKept.begin(), kAlwaysKept.end(),
                     [&](const char* stem) { return view_quantity.starts_with(stem); });
}

std::vector<double> values_of_view(const SelectedSurfaces& selected, const Scenario& scenario,
                                   const RegistrationTarget& target, const FacetModel& model,
                                   const RegisteredPoints& registered, const ScanPoints& scan,
                                   const RegistrationResult& result, const std::vector<bool>& wanted) {
  std::vector<double> values;
  values.reserve(wanted.size());
  const auto any_wanted = [&](std::size_t from, std::size_t count) {
    return std::find(wanted.begin() + static_cast<std::ptrdiff_t>(from),
                     wanted.begin() + static_cast<std::ptrdiff_t>(from + count),
                     true) != wanted.begin() + static_cast<std::ptrdiff_t>(from + count);
  };

  const Vec3& pivot = result.centroid_part_mm;
  const Vec6 error = step_between(registered.true_part_from_mcs, result.part_from_mcs, pivot);
  values.insert(values.end(), error.begin(), error.end());
  values.push_back(rotation_angle_between(result.part_from_mcs, registered.true_part_from_mcs));
  values.push_back(error.tail<3>().norm());
  values.push_back(static_cast<double>(scan.size()));
  values.push_back(wanted[values.size()] ? rms_distance_mm(target.tree(), scan.position_mcs_mm,
                                                           scenario.machine.mcs_from_part.inverse())
                                         : kNoValue);

  // rms, min and max come next; the errors of deviations stand at the end.
  std::optional<ReportedDeviations> reported;
  const std::size_t errors = 2 + 2 * selected.surfaces.size();
  if (any_wanted(values.size(), 3) || any_wanted(wanted.size() - errors, errors))
    reported = report(target, scenario, scan, result.part_from_mcs);
  values.push_back(reported ? reported->statistics.rms_mm : kNoValue);
  values.push_back(reported ? reported->statistics.min_mm : kNoValue);
  values.push_back(reported ? reported->statistics.max_mm : kNoValue);
  values.push_back(result.iterations);
  values.push_back(static_cast<double>(result.inliers));

  for (Eigen::Index k = 0; k < 6; ++k) values.push_back(std::sqrt(result.covariance(k, k)));
  for (const auto& [a, b] : {std::pair{3, 4}, std::pair{3, 5}, std::pair{4, 5}})
    values.push_back(result.covariance(a, b) / std::sqrt(result.covariance(a, a) * result.covariance(b, b)));
  const Eigen::LDLT<Mat6> covariance(result.covariance);
  const bool whole =
      result.undetermined.empty() && covariance.isPositive() && covariance.vectorD().minCoeff() > 0.0;
  values.push_back(whole ? error.dot(covariance.solve(error)) : kNoValue);

  const Vec6 bound = pose_bound(scenario, model, registered, pivot);
  values.insert(values.end(), bound.begin(), bound.end());

  DeviationError all;
  std::map<std::uint32_t, DeviationError> by_surface;
  for (std::size_t i = 0; reported && i < registered.points.size(); ++i) {
    const double true_mm = registered.points[i].hit.deviation_mm;
    all.add(reported->deviations, i, true_mm);
    by_surface[reported->deviations.surface[i]].add(reported->deviations, i, true_mm);
  }
  values.push_back(all.rms_mm());
  values.push_back(all.largest_mm());
  for (const std::uint32_t surface : selected.surfaces) {
    values.push_back(by_surface[surface].mean_mm());
    values.push_back(by_surface[surface].largest_mm());
  }
  return values;
}

}  // namespace trueblade
