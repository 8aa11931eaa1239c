#include "hardware/view_angles.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace trueblade {
namespace {

using AccessOfView = std::vector<PointAccess>;

std::vector<double> candidate_angles(const AxisLimits& limits, double step_rad) {
  std::vector<double> angles;
  const auto count = static_cast<int>(std::floor(2.0 * std::numbers::pi / step_rad + 1e-9));
  for (int k = 0; k < count; ++k) {
    // Within the travel of the axis, as the turn nearest to zero that is.
    for (const double turn : {0.0, -2.0 * std::numbers::pi, 2.0 * std::numbers::pi}) {
      const double angle = k * step_rad + turn;
      if (angle < limits.lower.theta_rad || angle > limits.upper.theta_rad) continue;
      angles.push_back(angle);
      break;
    }
  }
  return angles;
}

struct Greedy {
  std::vector<std::size_t> chosen;
  double coverable_mm2 = 0.0;
};

Greedy greedy_cover(std::span<const SurfaceSample> samples, std::span<const AccessOfView> access,
                    const ViewAngleOptions& options) {
  double area = 0.0;
  for (const SurfaceSample& sample : samples) area += sample.area_mm2;
  std::vector<char> seen(samples.size(), false);
  Greedy result;
  while (result.chosen.size() < options.most_views) {
    std::size_t best = 0;
    double best_gain = 0.0;
    for (std::size_t view = 0; view < access.size(); ++view) {
      double gain = 0.0;
      for (std::size_t i = 0; i < samples.size(); ++i)
        if (!seen[i] && access[view][i] == PointAccess::measurable) gain += samples[i].area_mm2;
      // A later candidate must be clearly better, so that rounding does not decide among equals.
      if (gain > best_gain * (1.0 + 1e-9)) {
        best_gain = gain;
        best = view;
      }
    }
    if (best_gain == 0.0 || (!result.chosen.empty() && best_gain < options.least_gain * area)) break;
    result.chosen.push_back(best);
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (access[best][i] == PointAccess::measurable) seen[i] = true;
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (std::any_of(access.begin(), access.end(),
                    [&](const AccessOfView& view) { return view[i] == PointAccess::measurable; }))
      result.coverable_mm2 += samples[i].area_mm2;
  return result;
}

}  // namespace

void ViewAngleOptions::validate() const {
  const auto require = [](bool holds, const char* name, double value, const char* constraint) {
    if (!holds) throw InputError(fmt::format("view angles: {} is {}, must be {}", name, value, constraint));
  };
  // A tenth of a degree: 3600 candidates.
  require(candidate_step_rad >= 1.7e-3 && candidate_step_rad <= 3.15, "candidate step (deg)",
          candidate_step_rad * 180.0 / std::numbers::pi, "within 0.1 and 180");
  require(most_views >= 1, "most_views", static_cast<double>(most_views), "at least 1");
  require(least_gain >= 0.0 && least_gain < 1.0, "least_gain", least_gain, "at least 0 and below 1");
  require(sample_count >= 100 && sample_count <= 10'000'000, "sample_count",
          static_cast<double>(sample_count), "within 100 and 10000000");
}

ViewChoice choose_view_angles(const MachineGeometry& geometry, const Lens& lens, const AxisLimits& limits,
                              const Part& nominal, const RayCaster& nominal_caster,
                              const RigidTransform& part_from_mcs, const PlanOptions& plan,
                              const ViewAngleOptions& options) {
  geometry.validate();
  plan.validate(nominal, lens);
  options.validate();
  const ProbeClearance clearance(nominal.model, plan.probe);
  const AccessCheck check(nominal_caster, clearance, lens, plan.probe,
                          plan.max_incidence_rad.value_or(lens.max_incidence_rad));
  const std::vector<SurfaceSample> samples = sample_surfaces(nominal, plan.surfaces, options.sample_count);
  const std::vector<double> candidates = candidate_angles(limits, options.candidate_step_rad);
  std::vector<AccessOfView> access;
  access.reserve(candidates.size());
  for (const double theta : candidates)
    access.push_back(access_from_angle(geometry, part_from_mcs, theta, check, samples));

  const Greedy greedy = greedy_cover(samples, access, options);
  if (greedy.chosen.empty())
    throw InputError(fmt::format(
        "nothing of the chosen surfaces can be measured from any of {} rotary angles", candidates.size()));
  ViewChoice choice;
  std::vector<AccessOfView> chosen_access;
  for (const std::size_t view : greedy.chosen) {
    choice.theta_rad.push_back(candidates[view]);
    chosen_access.push_back(access[view]);
  }
  choice.coverage = summarise_coverage(choice.theta_rad, samples, chosen_access);
  double area = 0.0;
  for (const SurfaceSample& sample : samples) area += sample.area_mm2;
  choice.coverable = greedy.coverable_mm2 / area;
  return choice;
}

Coverage coverage_of_views(const MachineGeometry& geometry, const Lens& lens, const Part& nominal,
                           const RayCaster& nominal_caster, const RigidTransform& part_from_mcs,
                           const PlanOptions& plan, std::span<const double> theta_rad,
                           std::size_t sample_count) {
  geometry.validate();
  plan.validate(nominal, lens);
  const ProbeClearance clearance(nominal.model, plan.probe);
  const AccessCheck check(nominal_caster, clearance, lens, plan.probe,
                          plan.max_incidence_rad.value_or(lens.max_incidence_rad));
  const std::vector<SurfaceSample> samples = sample_surfaces(nominal, plan.surfaces, sample_count);
  std::vector<AccessOfView> access;
  for (const double theta : theta_rad)
    access.push_back(access_from_angle(geometry, part_from_mcs, theta, check, samples));
  return summarise_coverage(theta_rad, samples, access);
}

}  // namespace trueblade
