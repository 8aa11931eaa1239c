#include "inspection/result_json.h"

#include <nlohmann/json.hpp>

#include "geometry/atomic_file.h"
#include "inspection/evaluation_json.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

Json cross_check_json(const CrossCheck& check) {
  return {{"agrees", check.agrees},
          {"rotation_difference_rad", number_json(check.rotation_difference_rad)},
          {"centroid_difference_mm", number_json(check.centroid_difference_mm)},
          {"covariance_relative_difference", number_json(check.covariance_relative_difference)},
          {"closed_form_rotation_difference_rad", number_json(check.closed_form_rotation_difference_rad)},
          {"closed_form_difference_mm", number_json(check.closed_form_difference_mm)},
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
          {"colour_limit_mm", number_json(run.colour_limit_mm)},
          {"tolerance_mm", run.tolerance ? tolerance_json(*run.tolerance) : Json(nullptr)}};
}

Json view_json(const RunFacts& run, const ViewResult& view) {
  const RegistrationResult& r = view.registration;
  const bool registered = view.failure.empty();
  Json json = {{"view", view.view},
               {"failure", registered ? Json(nullptr) : Json(view.failure)},
               {"theta_rad", number_json(view.theta_rad)},
               {"points", view.statistics.points},
               {"surfaces", run.surfaces},
               {"facets", run.facets},
               {"samples",
                {{"planned", view.planned},
                 {"out_of_range", view.out_of_range},
                 {"missed", view.missed},
                 {"low_signal", view.low_signal},
                 {"points", view.statistics.points},
                 {"left_out_by_registration", r.outliers},
                 {"left_out_by_report", view.statistics.left_out}}},
               {"pose", pose_json(r.part_from_mcs)},
               {"pose_covariance", covariance_json(r.covariance)},
               {"pose_covariance_pivot_mm", vector_json(r.centroid_part_mm)},
               {"undetermined", undetermined_json(r)},
               {"iterations", r.iterations},
               {"termination", registered ? to_string(r.termination) : "not registered"},
               {"converged", registered && is_converged(r.termination)},
               {"shows_misfit", r.shows_misfit},
               {"inliers", r.inliers},
               {"outliers", r.outliers},
               {"initial_rms_mm", number_json(view.initial_rms_mm)},
               {"weighted_rms_mm", number_json(r.weighted_rms_mm)},
               {"rms_mm", number_json(view.statistics.rms_mm)},
               {"min_mm", number_json(view.statistics.min_mm)},
               {"max_mm", number_json(view.statistics.max_mm)},
               {"deviations", statistics_json(view.statistics)},
               {"deviations_from_facets", statistics_json(view.from_facets)},
               {"tolerance", view.tolerance ? counts_json(*view.tolerance) : Json(nullptr)},
               {"time_s",
                {{"scan", number_json(view.time.scan_s)},
                 {"register", number_json(view.time.register_s)},
                 {"evaluate", number_json(view.time.evaluate_s)}}}};
  json.update(registration_work_json(r));
  json["cross_check"] = r.cross_check ? cross_check_json(*r.cross_check) : Json(nullptr);
  json["truth"] = view.truth
                      ? Json{{"pose", pose_json(view.truth->true_part_from_mcs)},
                             {"translation_error_mm", number_json(view.truth->translation_error_mm)},
                             {"rotation_error_rad", number_json(view.truth->rotation_error_rad)},
                             {"true_deviation_rms_mm", number_json(view.truth->true_deviation_rms_mm)},
                             {"deviation_error_rms_mm", number_json(view.truth->deviation_error_rms_mm)}}
                      : Json(nullptr);
  json["per_surface"] = Json::array();
  for (const SurfaceStatistics& surface : view.surfaces) {
    Json entry = {{"surface", surface.surface}, {"name", surface.name}};
    entry.update(statistics_json(surface.statistics));
    entry["deviations_from_facets"] = statistics_json(surface.from_facets);
    entry["tolerance"] = surface.tolerance ? counts_json(*surface.tolerance) : Json(nullptr);
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
  json.update(evaluation_json(result.evaluation));
  return json;
}

void write_result_json(const std::filesystem::path& file, const InspectionResult& result) {
  // File names need not be valid UTF-8; a replacement character is better than no result.
  const std::string text = result_json(result).dump(2, ' ', false, Json::error_handler_t::replace);
  write_file_atomically(file, [&](std::ostream& out) { out << text << '\n'; });
}

}  // namespace trueblade
