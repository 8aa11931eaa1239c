#include "inspection/result_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/atomic_file.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json pose_json(const RigidTransform& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Vec3& t = pose.translation_mm;
  return {{"rotation_wxyz", {number(q.w()), number(q.x()), number(q.y()), number(q.z())}},
          {"translation_mm", {number(t.x()), number(t.y()), number(t.z())}}};
}

Json vector_json(const Vec3& v) {
  return {number(v.x()), number(v.y()), number(v.z())};
}

Json covariance_json(const Mat6& covariance) {
  Json rows = Json::array();
  for (int r = 0; r < 6; ++r) {
    Json row = Json::array();
    for (int c = 0; c < 6; ++c) row.push_back(number(covariance(r, c)));
    rows.push_back(row);
  }
  return rows;
}

Json statistics_json(const DeviationStatistics& s) {
  return {{"points", s.points},
          {"outliers", s.left_out},
          {"min_mm", number(s.min_mm)},
          {"max_mm", number(s.max_mm)},
          {"mean_mm", number(s.mean_mm)},
          {"rms_mm", number(s.rms_mm)},
          {"standard_deviation_mm", number(s.standard_deviation_mm)},
          {"mean_positive_mm", number(s.mean_positive_mm)},
          {"mean_negative_mm", number(s.mean_negative_mm)}};
}

Json cross_check_json(const CrossCheck& check) {
  return {{"agrees", check.agrees},
          {"rotation_difference_rad", number(check.rotation_difference_rad)},
          {"centroid_difference_mm", number(check.centroid_difference_mm)},
          {"covariance_relative_difference", number(check.covariance_relative_difference)},
          {"summary", check.summary}};
}

Json run_json(const RunFacts& run) {
  return {{"program_version", run.program_version},
          {"scenario", run.scenario},
          {"seed", run.seed},
          {"date", run.date.empty() ? Json(nullptr) : Json(run.date)},
          {"machine", run.machine},
          {"lens", run.lens},
          {"part", run.part},
          {"surfaces", run.surfaces},
          {"facets", run.facets},
          {"registration_preset", run.registration_preset},
          {"deviations_from", run.deviations_from},
          {"colour_map", to_string(run.colour_map)},
          {"colour_limit_mm", number(run.colour_limit_mm)}};
}

Json view_json(const RunFacts& run, const ViewResult& view) {
  const RegistrationResult& r = view.registration;
  Json undetermined = Json::array();
  for (const UndeterminedDirection& direction : r.undetermined) undetermined.push_back(direction.words);

  Json json = {{"view", view.view},
               {"theta_rad", number(view.theta_rad)},
               {"points", view.statistics.points},
               {"surfaces", run.surfaces},
               {"facets", run.facets},
               {"samples",
                {{"planned", view.planned},
                 {"out_of_range", view.out_of_range},
                 {"missed", view.missed},
                 {"low_signal", view.low_signal}}},
               {"pose", pose_json(r.part_from_mcs)},
               {"pose_covariance", covariance_json(r.covariance)},
               {"pose_covariance_pivot_mm", vector_json(r.centroid_part_mm)},
               {"undetermined", undetermined},
               {"iterations", r.iterations},
               {"termination", to_string(r.termination)},
               {"converged", is_converged(r.termination)},
               {"inliers", r.inliers},
               {"outliers", r.outliers},
               {"initial_rms_mm", number(r.initial_rms_mm)},
               {"weighted_rms_mm", number(r.weighted_rms_mm)},
               {"rms_mm", number(view.statistics.rms_mm)},
               {"min_mm", number(view.statistics.min_mm)},
               {"max_mm", number(view.statistics.max_mm)},
               {"deviations", statistics_json(view.statistics)},
               {"time_s",
                {{"scan", number(view.time.scan_s)},
                 {"register", number(view.time.register_s)},
                 {"evaluate", number(view.time.evaluate_s)}}}};
  json["cross_check"] = r.cross_check ? cross_check_json(*r.cross_check) : Json(nullptr);
  json["truth"] = view.truth ? Json{{"pose", pose_json(view.truth->true_part_from_mcs)},
                                    {"translation_error_mm", number(view.truth->translation_error_mm)},
                                    {"rotation_error_rad", number(view.truth->rotation_error_rad)},
                                    {"true_deviation_rms_mm", number(view.truth->true_deviation_rms_mm)},
                                    {"deviation_error_rms_mm", number(view.truth->deviation_error_rms_mm)}}
                             : Json(nullptr);
  json["per_surface"] = Json::array();
  for (const SurfaceStatistics& surface : view.surfaces) {
    Json entry = {{"surface", surface.surface}, {"name", surface.name}};
    entry.update(statistics_json(surface.statistics));
    json["per_surface"].push_back(entry);
  }
  return json;
}

}  // namespace

Json result_json(const InspectionResult& result) {
  Json json = {{"schema", "trueblade-result"},
               {"schema_version", kResultSchemaVersion},
               {"units", {{"length", "mm"}, {"angle", "rad"}, {"time", "s"}, {"pose", "part_from_mcs"}}},
               {"outlier_rules",
                {{"registration", result.run.rejection_rule},
                 {"report", "signed deviation more than 3 standard deviations from the mean of all, once"}}},
               {"run", run_json(result.run)},
               {"views", Json::array()}};
  for (const ViewResult& view : result.views) json["views"].push_back(view_json(result.run, view));
  return json;
}

void write_result_json(const std::filesystem::path& file, const InspectionResult& result) {
  // File names need not be valid UTF-8; a replacement character is better than no result.
  const std::string text = result_json(result).dump(2, ' ', false, Json::error_handler_t::replace);
  write_file_atomically(file, [&](std::ostream& out) { out << text << '\n'; });
}

}  // namespace trueblade
