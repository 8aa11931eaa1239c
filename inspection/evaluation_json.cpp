#include "inspection/evaluation_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kComponents[] = {"rotation_x_rad",   "rotation_y_rad",   "rotation_z_rad",
                                       "translation_x_mm", "translation_y_mm", "translation_z_mm"};

Json difference_json(const PoseDifference& difference) {
  Json components = Json::object();
  for (std::size_t k = 0; k < 6; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const bool known = difference.determined[k];
    const double variance = difference.covariance(row, row);
    components[kComponents[k]] = {
        {"value", known ? number_json(difference.step[row]) : Json(nullptr)},
        {"standard_uncertainty", known ? number_json(std::sqrt(std::max(variance, 0.0))) : Json(nullptr)}};
  }
  return {{"of", difference.of},
          {"from", difference.from},
          {"pivot_mm", vector_json(difference.pivot_mm)},
          {"components", components}};
}

Json differences_json(const std::vector<PoseDifference>& differences) {
  Json list = Json::array();
  for (const PoseDifference& difference : differences) list.push_back(difference_json(difference));
  return list;
}

Json joint_json(const JointResult& joint) {
  const RegistrationResult& r = joint.registration;
  Json views = Json::array();
  for (const JointView& view : joint.views)
    views.push_back({{"view", view.view},
                     {"deviations", statistics_json(view.statistics)},
                     {"alone", difference_json(view.alone)}});
  Json json = {{"pose", pose_json(r.part_from_mcs)},
               {"pose_covariance", covariance_json(r.covariance)},
               {"pose_covariance_pivot_mm", vector_json(r.centroid_part_mm)},
               {"termination", to_string(r.termination)},
               {"converged", is_converged(r.termination)},
               {"iterations", r.iterations},
               {"shows_misfit", r.shows_misfit},
               {"inliers", r.inliers},
               {"outliers", r.outliers},
               {"deviations", statistics_json(joint.statistics)},
               {"views", views},
               {"between_views", differences_json(joint.between_views)}};
  json["undetermined"] = undetermined_json(r);
  json.update(registration_work_json(r));
  return json;
}

Json profile_json(const ProfileResult& profile) {
  Json counts = counts_json(profile.counts);
  return {{"name", profile.callout.name},
          {"surfaces", profile.callout.surfaces},
          {"tolerance_mm", tolerance_json(profile.callout.tolerance)},
          {"points", profile.points},
          {"outliers", profile.outliers},
          {"min_mm", number_json(profile.min_mm)},
          {"max_mm", number_json(profile.max_mm)},
          {"profile_mm", number_json(profile.profile_mm)},
          {"standard_uncertainty_mm", number_json(profile.uncertainty_mm)},
          {"guard_mm", number_json(profile.guard_mm)},
          {"rejection_guard_mm", number_json(profile.rejection_guard_mm)},
          {"rejection_factor", number_json(profile.rejection_factor)},
          {"counts", counts},
          {"conformity", to_string(profile.conformity)},
          {"reason", profile.reason}};
}

// Pictures need no more than 0.01 um.
Json rounded(double mm) {
  return std::isfinite(mm) ? Json(std::round(mm * 1e5) / 1e5) : Json(nullptr);
}

Json stretches_json(const std::vector<ProfileStretch>& stretches) {
  Json list = Json::array();
  for (const ProfileStretch& stretch : stretches)
    list.push_back({{"profile", stretch.profile}, {"first", stretch.first}, {"last", stretch.last}});
  return list;
}

Json section_json(const SectionResult& section, const std::vector<ProfileStretch>& stretches) {
  Json features = Json::array();
  for (const SectionFeature& f : section.features)
    features.push_back({{"name", f.name},
                        {"unit", f.unit},
                        {"method", f.method},
                        {"nominal", number_json(f.nominal)},
                        {"measured", number_json(f.measured)},
                        {"deviation", number_json(f.deviation())},
                        {"standard_uncertainty", number_json(f.uncertainty)},
                        {"reason", f.reason.empty() ? Json(nullptr) : Json(f.reason)}});
  Json outline = Json::array(), points = Json::array();
  for (std::size_t i = 0; i < section.outline_mm.size(); ++i)
    outline.push_back({rounded(section.outline_mm[i].x()), rounded(section.outline_mm[i].y()),
                       rounded(section.outline_normal[i].x()), rounded(section.outline_normal[i].y()),
                       rounded(section.fitted_deviation_mm[i])});
  for (std::size_t i = 0; i < section.foot_mm.size(); ++i)
    points.push_back(
        {rounded(section.foot_mm[i].x()), rounded(section.foot_mm[i].y()), rounded(section.deviation_mm[i])});
  return {{"height_mm", section.height_mm},
          {"points", section.points},
          {"covered_percent", number_json(section.covered_percent)},
          {"missing", section.missing.empty() ? Json(nullptr) : Json(section.missing)},
          {"features", features},
          {"profile_stretches", stretches_json(stretches)},
          {"outline_x_y_normal_deviation", outline},
          {"points_x_y_deviation", points}};
}

}  // namespace

Json number_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json vector_json(const Vec3& v) {
  return {number_json(v.x()), number_json(v.y()), number_json(v.z())};
}

Json pose_json(const RigidTransform& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"rotation_wxyz", {number_json(q.w()), number_json(q.x()), number_json(q.y()), number_json(q.z())}},
          {"translation_mm", vector_json(pose.translation_mm)}};
}

Json undetermined_json(const RegistrationResult& registration) {
  Json list = Json::array();
  for (const UndeterminedDirection& direction : registration.undetermined) list.push_back(direction.words);
  return list;
}

Json registration_work_json(const RegistrationResult& registration) {
  const ClosestPointWork& work = registration.work;
  return {
      {"sigma_mm", number_json(registration.sigma_mm)},
      {"sigma_estimated", registration.sigma_estimated},
      {"closest_points",
       {{"queries", work.queries}, {"facets_tested", work.facets_tested}, {"cache_hits", work.cache_hits}}}};
}

Json covariance_json(const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < covariance.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < covariance.cols(); ++c) row.push_back(number_json(covariance(r, c)));
    rows.push_back(row);
  }
  return rows;
}

Json statistics_json(const DeviationStatistics& s) {
  return {{"points", s.points},
          {"outliers", s.left_out},
          {"min_mm", number_json(s.min_mm)},
          {"max_mm", number_json(s.max_mm)},
          {"mean_mm", number_json(s.mean_mm)},
          {"rms_mm", number_json(s.rms_mm)},
          {"standard_deviation_mm", number_json(s.standard_deviation_mm)},
          {"mean_positive_mm", number_json(s.mean_positive_mm)},
          {"mean_negative_mm", number_json(s.mean_negative_mm)}};
}

Json tolerance_json(const Tolerance& tolerance) {
  return {number_json(tolerance.lower_mm), number_json(tolerance.upper_mm)};
}

Json counts_json(const ToleranceCounts& counts) {
  return {{"within", counts.within},
          {"over", counts.over},
          {"under", counts.under},
          {"outliers_outside", counts.outliers_outside},
          {"percent_within", number_json(counts.percent(counts.within))},
          {"percent_over", number_json(counts.percent(counts.over))},
          {"percent_under", number_json(counts.percent(counts.under))}};
}

Json evaluation_json(const EvaluationResult& evaluation) {
  Json profiles = Json::array(), sections = Json::array(), groups = Json::array();
  for (const ProfileResult& profile : evaluation.profiles) profiles.push_back(profile_json(profile));
  for (std::size_t k = 0; k < evaluation.sections.size(); ++k)
    sections.push_back(section_json(evaluation.sections[k], evaluation.section_profiles[k]));
  for (const GroupFit& group : evaluation.groups)
    groups.push_back({{"name", group.name}, {"points", group.points}, {"rms_mm", number_json(group.rms_mm)}});
  return {{"datum_surfaces", evaluation.datum_surfaces},
          {"joint", evaluation.joint ? joint_json(*evaluation.joint) : Json(nullptr)},
          {"profiles", profiles},
          {"sections", sections},
          {"groups", groups},
          {"offsets", differences_json(evaluation.offsets)},
          {"missing", evaluation.missing},
          {"missing_features", evaluation.missing_features}};
}

}  // namespace trueblade
