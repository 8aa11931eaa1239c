#include "apps/inspect_scenario.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "apps/deviation_error.h"
#include "apps/evaluate_view.h"
#include "apps/interrupt.h"
#include "apps/measure.h"
#include "apps/run_folder.h"
#include "apps/run_report.h"
#include "apps/version.h"
#include "geometry/atomic_file.h"
#include "geometry/error.h"
#include "hardware/scan_file.h"
#include "inspection/deviation_ply.h"
#include "inspection/part_pictures.h"
#include "inspection/range_image_exr.h"
#include "inspection/render_png.h"
#include "inspection/result_json.h"
#include "inspection/surface_selection.h"
#include "registration/correspondences.h"
#include "registration/rejection.h"

namespace trueblade {
namespace {

using Folder = std::filesystem::path;

struct FinishedView {
  MeasuredView measured;
  EvaluatedView evaluated;
};

// Resolved before the scan: a name that the part does not have would be noticed only after it.
std::vector<std::uint32_t> datum_surfaces_of(const Scenario& scenario, const Part& part) {
  try {
    return select_surfaces(part, scenario.inspection.datum_surfaces);
  } catch (const InputError& failure) {
    throw InputError(fmt::format("datum_surfaces: {}", failure.what()));
  }
}

std::optional<Tolerance> tolerance_of(const InspectionSpec& inspection) {
  if (!inspection.tolerance_mm) return std::nullopt;
  return Tolerance{inspection.tolerance_mm->first, inspection.tolerance_mm->second};
}

RunFacts run_facts(const Scenario& scenario, const Part& part) {
  RunFacts run;
  run.program_version = fmt::format("{} ({})", program_version(), program_commit());
  run.scenario = scenario.name;
  run.seed = scenario.seed;
  run.date = date_now();
  run.machine = scenario.machine.backend;
  run.lens = scenario.machine.lens.name;
  run.part = title_of(scenario.part);
  run.surfaces = part.surfaces.size();
  run.facets = part.model.facet_count();
  run.registration_preset = scenario.registration.preset;
  run.rejection_rule = in_words(scenario.registration.options.rejection);
  run.deviations_from = to_string(scenario.inspection.surface);
  run.colour_map = scenario.inspection.colour_map;
  run.tolerance = tolerance_of(scenario.inspection);
  return run;
}

void prepare_run_folder(const Folder& folder, const Scenario& scenario) {
  create_output_folder(folder);
  std::filesystem::remove(folder / "result.json");
  write_file_atomically(folder / "resolved.yaml", [&](std::ostream& out) {
    out << fmt::format("# The whole scenario as it ran, with its defaults: trueblade {} ({})\n",
                       program_version(), program_commit())
        << scenario_text(scenario);
  });
}

void count_samples(const MeasuredView& measured, ViewResult& result) {
  result.theta_rad = measured.scan.theta_rad;
  result.planned = measured.planned;
  result.time.scan_s = measured.scan.time_s;
  for (const ProbeSample& sample : measured.scan.samples) {
    result.out_of_range += sample.flags.out_of_range;
    result.missed += sample.flags.missed;
    result.low_signal += sample.flags.low_signal;
  }
}

// How well the report tells the form of the part that truly stood there.
void compare_with_true_form(const MeasuredTruth& truth, const Deviations& reported, PoseError& error) {
  DeviationError of_points;
  double true_square = 0.0;
  for (std::size_t i = 0; i < reported.size(); ++i) {
    const std::size_t before = of_points.count;
    of_points.add(reported, i, truth.deviation_mm[i]);
    if (of_points.count > before) true_square += truth.deviation_mm[i] * truth.deviation_mm[i];
  }
  error.true_deviation_rms_mm = std::sqrt(true_square / static_cast<double>(of_points.count));
  error.deviation_error_rms_mm = of_points.rms_mm();
}

// A real machine follows its plan blindly, and so does this one: how many samples became points is a result.
void tell_samples(const ViewResult& result, std::size_t points) {
  spdlog::info(
      "view {}: {} of {} planned samples became points; {} fell out of the working range, {} did not return",
      result.view, points, result.planned, result.out_of_range, result.missed);
}

// One view of several seldom determines the pose by the datum surfaces it sees: there they hold all views
// together (evaluate_together), and each view keeps its best fit.
ViewEvaluationOptions view_options(const Scenario& scenario, const std::vector<ScanPlan>& plans,
                                   const std::vector<std::uint32_t>& datum_surfaces) {
  const bool only_view = std::count_if(plans.begin(), plans.end(),
                                       [](const ScanPlan& plan) { return !plan.lines.empty(); }) == 1;
  return {scenario.registration.options, scenario.inspection.surface,
          only_view ? datum_surfaces : std::vector<std::uint32_t>{}, tolerance_of(scenario.inspection)};
}

FinishedView finish_view(const Scenario& scenario, const RegistrationTarget& target,
                         const ViewEvaluationOptions& options, MeasuredView measured) {
  FinishedView view;
  std::optional<RigidTransform> true_pose;
  if (measured.truth) true_pose = measured.truth->part_from_mcs;
  view.evaluated = evaluate_view(target, measured.scan.view, measured.scan.points,
                                 scenario.machine.mcs_from_part.inverse(), options, true_pose);
  count_samples(measured, view.evaluated.result);
  tell_samples(view.evaluated.result, measured.scan.points.size());
  if (measured.truth && !measured.truth->deviation_mm.empty() && view.evaluated.result.truth)
    compare_with_true_form(*measured.truth, view.evaluated.deviations, *view.evaluated.result.truth);
  view.measured = std::move(measured);
  return view;
}

// Messages of the measurement name the view; whoever shows a result names it already.
std::string without_view(const std::string& message, const std::string& view) {
  const std::string prefix = fmt::format("view {}: ", view);
  return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
}

// A view that could not be measured or registered: its name, what was measured, and why.
ViewResult failed_view(const ScanPlan& plan, const MeasuredView& measured, const std::string& failure) {
  ViewResult view;
  count_samples(measured, view);
  view.view = plan.view;
  view.theta_rad = plan.theta_rad;
  view.planned = plan.point_count();
  view.failure = without_view(failure, plan.view);
  view.statistics.points = measured.scan.points.size();
  view.registration.weighted_rms_mm = kNoValue;
  return view;
}

EvaluationSpec evaluation_spec(const Scenario& scenario, const std::vector<std::uint32_t>& datum_surfaces,
                               bool views_on_datum) {
  const InspectionSpec& inspection = scenario.inspection;
  return {inspection.profiles, inspection.sections,
          inspection.groups,   datum_surfaces,
          views_on_datum,      inspection.point_uncertainty_mm.value_or(scenario.machine.lens.accuracy_mm)};
}

std::vector<ScanOfView> scans_of(const std::vector<FinishedView>& views) {
  std::vector<ScanOfView> scans;
  for (const FinishedView& view : views)
    scans.push_back({view.evaluated.result.view, &view.measured.scan.points,
                     &view.evaluated.result.registration, &view.evaluated.deviations});
  return scans;
}

double colour_limit_mm(const Scenario& scenario, const std::vector<FinishedView>& views) {
  if (scenario.inspection.colour_limit_mm) return *scenario.inspection.colour_limit_mm;
  double largest_rms_mm = 0.0;
  for (const FinishedView& view : views) {
    const double rms_mm = view.evaluated.result.statistics.rms_mm;
    if (rms_mm > largest_rms_mm) largest_rms_mm = rms_mm;  // false for NaN: a view without points
  }
  return rounded_colour_limit_mm(largest_rms_mm);
}

PointsTogether together_of(const std::optional<JointResult>& joint, const std::string& view) {
  if (!joint) return {};
  const auto found = std::find_if(joint->views.begin(), joint->views.end(),
                                  [&](const JointView& candidate) { return candidate.view == view; });
  return {&joint->deviations, found->first_point};
}

void write_view(const Folder& folder, const Scenario& scenario, const PartOnMachine& nominal,
                const FinishedView& view, const InspectionResult& inspection) {
  const RunFacts& run = inspection.run;
  const ViewResult& result = view.evaluated.result;
  const Deviations& deviations = view.evaluated.deviations;
  const RigidTransform& part_from_mcs = result.registration.part_from_mcs;
  const MachineGeometry& geometry = scenario.machine.geometry;
  const Vec3 beam_mcs = beam_in_mcs(geometry, {.theta_rad = result.theta_rad}).direction;
  write_deviation_ply(folder / fmt::format("deviations_{}.ply", result.view), deviations, result.view, run,
                      together_of(inspection.evaluation.joint, result.view));
  write_range_image_exr(
      folder / fmt::format("{}.exr", result.view),
      range_image_of(view.measured.scan, deviations, part_from_mcs, run, beam_mcs,
                     view.measured.truth ? view.measured.truth->deviation_mm : std::vector<double>()));

  const Viewpoint viewpoint = viewpoint_of_view(result.view, geometry, result.theta_rad, part_from_mcs);
  PictureOptions picture;
  picture.tolerance = run.tolerance;
  render_deviation_png(folder / fmt::format("{}.png", result.view), *nominal.part, *nominal.caster,
                       deviations, result, run, viewpoint, picture);
}

// With the points at the pose at which the part as a whole is judged.
void write_part_pictures(const Folder& folder, const PartOnMachine& nominal,
                         const std::vector<FinishedView>& views, const InspectionResult& inspection) {
  if (views.empty()) return;
  create_output_folder(folder);
  const auto render = [&](const Deviations& deviations, const ViewResult& title) {
    render_part_pictures(folder, *nominal.part, *nominal.caster, deviations, title, inspection.run);
  };
  const std::optional<JointResult>& joint = inspection.evaluation.joint;
  if (!joint) return render(views.front().evaluated.deviations, views.front().evaluated.result);
  ViewResult all;
  all.view = joint->views.size() > 1 ? "all views together"
                                     : fmt::format("{}, on the datum surfaces", joint->views.front().view);
  all.statistics = joint->statistics;
  render(joint->deviations, all);
}

}  // namespace

InspectionRun inspect_scenario(const Scenario& scenario, const std::optional<Folder>& run_folder,
                               bool resume) {
  spdlog::info("part {}", title_of(scenario.part));
  const PartOnMachine nominal = put_on_machine(make_part(scenario.part));
  spdlog::info("part has {} surfaces, {} facets", nominal.part->surfaces.size(),
               nominal.part->model.facet_count());
  // What the registration would refuse after the scan.
  require_surfaces(*nominal.part, scenario.registration.options.surfaces);
  const std::vector<std::uint32_t> datum_surfaces = datum_surfaces_of(scenario, *nominal.part);
  InspectionRun run;
  run.result.run = run_facts(scenario, *nominal.part);
  const RegistrationTarget target(*nominal.part);
  Measurement measurement(scenario, nominal, true);
  if (run_folder) {
    prepare_run_folder(*run_folder, scenario);
    measurement.keep_journal(*run_folder / "scan.journal", resume);
  }
  const ViewEvaluationOptions options = view_options(scenario, measurement.plans(), datum_surfaces);
  std::vector<FinishedView> views;
  for (const ScanPlan& plan : measurement.plans()) {
    MeasuredView measured;
    try {
      measured = measurement.measure(plan);
      if (run_folder) write_scan(*run_folder / fmt::format("scan_{}.ply", plan.view), measured.scan);
      run.interrupted = !measured.scan.complete || interrupted();
      if (run.interrupted) break;
      spdlog::info("registering {} points of view {}", measured.scan.points.size(), plan.view);
      views.push_back(finish_view(scenario, target, options, measured));
      run.result.views.push_back(views.back().evaluated.result);
    } catch (const InputError& failure) {
      run.result.views.push_back(failed_view(plan, measured, failure.what()));
    }
  }

  run.result.run.colour_limit_mm = colour_limit_mm(scenario, views);
  run.result.evaluation =
      evaluate_together(evaluation_spec(scenario, datum_surfaces, !options.datum_surfaces.empty()), target,
                        scenario.registration.options, scenario.inspection.surface, scans_of(views));
  if (run_folder) {
    for (const FinishedView& view : views) write_view(*run_folder, scenario, nominal, view, run.result);
    write_part_pictures(*run_folder / "pictures", nominal, views, run.result);
    if (!run.result.views.empty()) {
      write_result_json(*run_folder / "result.json", run.result);
      write_run_report(*run_folder, nominal.part.get());
    }
  }
  return run;
}

}  // namespace trueblade
