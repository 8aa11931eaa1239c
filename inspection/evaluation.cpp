#include "inspection/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "geometry/error.h"
#include "inspection/datum_fit.h"
#include "inspection/deviation_uncertainty.h"
#include "inspection/surface_selection.h"

namespace trueblade {
namespace {

ScanPoints all_points(const std::vector<ScanOfView>& views) {
  ScanPoints all;
  const bool with_snr = std::all_of(views.begin(), views.end(), [](const ScanOfView& view) {
    return view.scan->snr.size() == view.scan->size();
  });
  for (const ScanOfView& view : views) {
    all.position_mcs_mm.insert(all.position_mcs_mm.end(), view.scan->position_mcs_mm.begin(),
                               view.scan->position_mcs_mm.end());
    if (with_snr) all.snr.insert(all.snr.end(), view.scan->snr.begin(), view.scan->snr.end());
  }
  return all;
}

DeviationStatistics statistics_within(const Deviations& d, std::size_t begin, std::size_t count) {
  const auto first = static_cast<std::ptrdiff_t>(begin);
  const auto last = static_cast<std::ptrdiff_t>(begin + count);
  const std::vector<bool> left_out(d.outliers.is_outlier.begin() + first,
                                   d.outliers.is_outlier.begin() + last);
  return statistics_of(std::span(d.signed_mm).subspan(begin, count), left_out);
}

JointResult joint_result(const std::vector<ScanOfView>& views, Deviations all,
                         const RegistrationResult& registration) {
  JointResult joint;
  joint.registration = registration;
  joint.deviations = std::move(all);
  const Deviations& deviations = joint.deviations;
  joint.statistics = statistics_of(deviations.signed_mm, deviations.outliers.is_outlier);
  std::size_t begin = 0;
  for (const ScanOfView& view : views) {
    joint.views.push_back({view.name, statistics_within(deviations, begin, view.scan->size()),
                           pose_difference(view.name, *view.registration, "all views", registration), begin});
    begin += view.scan->size();
    if (&view != &views.front())
      joint.between_views.push_back(
          pose_difference(view.name, *view.registration, views.front().name, *views.front().registration));
  }
  return joint;
}

// Does one piece of work; what it throws is put on the list of what is missing.
void attempt(const std::string& what, std::vector<std::string>& missing, const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& failure) {
    missing.push_back(fmt::format("{}: {}", what, failure.what()));
  }
}

// Each group of surfaces is fitted by itself, from the pose of the whole.
void compare_groups(const EvaluationSpec& spec, const RegistrationTarget& target,
                    const RegistrationOptions& options, const ScanPoints& scan,
                    const RigidTransform& part_from_mcs, EvaluationResult& result) {
  std::optional<RegistrationResult> reference;
  for (const GroupSpec& group : spec.groups) {
    attempt("group " + group.name, result.missing, [&] {
      RegistrationOptions on_group = options;
      on_group.surfaces = select_surfaces(target.part(), group.surfaces);
      if (on_group.surfaces.empty()) throw InputError("no surfaces are named");
      const bool first = &group == &spec.groups.front();
      if (!first && !reference) throw InputError("there is nothing to compare it with");
      const RegistrationResult fit = register_scan(target, scan, part_from_mcs, on_group);
      // The fit starts at the minimum of all points: where no step descends, it is at its own.
      if (!is_converged(fit.termination) && fit.termination != Termination::no_descent)
        throw InputError("its fit did not converge (" + to_string(fit.termination) + ")");
      result.groups.push_back({group.name, fit.inliers, fit.rms_mm});
      if (first) {
        reference = fit;
      } else {
        result.offsets.push_back(pose_difference(group.name, fit, spec.groups.front().name, *reference));
      }
    });
  }
}

void judge_profiles(const EvaluationSpec& spec, const Part& part, const Deviations& deviations,
                    const RegistrationResult& registration, EvaluationResult& result) {
  const std::vector<double> uncertainty_mm =
      deviation_uncertainty_mm(deviations, registration, spec.point_uncertainty_mm);
  for (const ProfileSpec& profile : spec.profiles) {
    attempt("profile " + profile.name, result.missing, [&] {
      const ProfileCallout callout{profile.name, select_surfaces(part, profile.surfaces), profile.tolerance};
      result.profiles.push_back(evaluate_profile(callout, part, deviations, uncertainty_mm));
    });
  }
}

void measure_sections(const EvaluationSpec& spec, const RegistrationTarget& target,
                      const Deviations& deviations, EvaluationResult& result) {
  if (!spec.sections) return;
  const Part& part = target.part();
  for (const double height_mm : spec.sections->heights_mm) {
    result.sections.push_back(measure_section(part, *spec.sections, height_mm, deviations));
    const SectionResult& section = result.sections.back();
    result.section_profiles.push_back(
        profile_stretches(target, spec.sections->plane(height_mm), section.outline_mm, result.profiles));
    if (!section.missing.empty())
      result.missing.push_back(fmt::format("section at {:g} mm: {}", height_mm, section.missing));
  }
  add_bow(result.sections);
  for (const SectionResult& section : result.sections)
    for (const SectionFeature& feature : section.features)
      if (!feature.reason.empty())
        result.missing_features.push_back(
            fmt::format("section at {:g} mm: no {} ({})", section.height_mm, feature.name, feature.reason));
}

}  // namespace

EvaluationResult evaluate_together(const EvaluationSpec& spec, const RegistrationTarget& target,
                                   const RegistrationOptions& options, DeviationSurface surface,
                                   const std::vector<ScanOfView>& views) {
  EvaluationResult result;
  result.datum_surfaces = spec.datum_surfaces;
  const bool anything = !spec.profiles.empty() || spec.sections || !spec.groups.empty();
  if (views.empty()) {
    if (anything) result.missing.emplace_back("profiles, sections and offsets: no view was registered");
    return result;
  }
  if (views.size() == 1 && (spec.datum_surfaces.empty() || spec.views_on_datum)) {
    const ScanOfView& only = views.front();
    judge_profiles(spec, target.part(), *only.deviations, *only.registration, result);
    measure_sections(spec, target, *only.deviations, result);
    compare_groups(spec, target, options, *only.scan, only.registration->part_from_mcs, result);
    return result;
  }

  const ScanPoints all = all_points(views);
  std::string what = views.size() > 1 ? "joint registration" : "fit to the datum surfaces";
  if (anything) what += ", and with it profiles, sections and offsets";
  attempt(what, result.missing, [&] {
    const RegistrationResult registration = register_to_datum(
        target, all, views.front().registration->part_from_mcs, options, spec.datum_surfaces);
    result.joint = joint_result(views,
                                evaluate_deviations(target.part(), target.tree(), target.pseudo_normals(),
                                                    all, registration.part_from_mcs, {surface}),
                                registration);
    const Deviations& deviations = result.joint->deviations;
    judge_profiles(spec, target.part(), deviations, registration, result);
    measure_sections(spec, target, deviations, result);
    compare_groups(spec, target, options, all, registration.part_from_mcs, result);
  });
  return result;
}

}  // namespace trueblade
