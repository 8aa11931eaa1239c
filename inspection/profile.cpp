#include "inspection/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

void check_surfaces(const ProfileCallout& callout, std::size_t surfaces) {
  for (const std::uint32_t surface : callout.surfaces) {
    if (surface >= surfaces) {
      throw InputError(fmt::format("profile '{}': surface {} does not exist, the part has surfaces 0 to {}",
                                   callout.name, surface, surfaces - 1));
    }
  }
}

bool is_on(const ProfileCallout& callout, std::uint32_t surface) {
  return callout.surfaces.empty() ||
         std::find(callout.surfaces.begin(), callout.surfaces.end(), surface) != callout.surfaces.end();
}

// How far a deviation lies outside the zone; negative inside.
double excess_mm(const Tolerance& tolerance, double deviation_mm) {
  return std::max(deviation_mm - tolerance.upper_mm, tolerance.lower_mm - deviation_mm);
}

struct Worst {
  double excess_mm = -std::numeric_limits<double>::infinity();
  double guard_mm = kNoValue;
};

void decide(ProfileResult& result, std::size_t bad, std::size_t doubtful, std::size_t outliers_outside) {
  if (result.points == result.outliers) {
    result.reason = "no point was measured on these surfaces";
  } else if (bad > 0) {
    result.conformity = Conformity::not_conforming;
    result.reason = fmt::format("{} points lie outside the zone by more than the guard band", bad);
  } else if (doubtful > 0) {
    result.reason = fmt::format("{} points lie within the guard band of a limit", doubtful);
  } else if (outliers_outside > 0) {
    result.reason = fmt::format("{} outliers lie outside the zone", outliers_outside);
  } else {
    result.conformity = Conformity::conforming;
    result.reason = "all points lie inside the zone by at least the guard band";
  }
}

}  // namespace

std::string to_string(Conformity conformity) {
  switch (conformity) {
    case Conformity::conforming:
      return "conforming";
    case Conformity::not_conforming:
      return "not conforming";
    case Conformity::cannot_tell:
      return "cannot tell";
  }
  return "";
}

ProfileResult evaluate_profile(const ProfileCallout& callout, const Part& part, const Deviations& deviations,
                               std::span<const double> uncertainty_mm) {
  callout.tolerance.validate();
  check_surfaces(callout, part.surfaces.size());
  const Tolerance& tolerance = callout.tolerance;

  ProfileResult result;
  result.callout = callout;
  std::vector<double> on_surfaces_mm;
  std::vector<bool> left_out;
  std::size_t bad = 0, doubtful = 0, outliers_outside = 0;
  Worst worst;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    if (!is_on(callout, deviations.surface[i])) continue;
    ++result.points;
    const double outside_mm = excess_mm(tolerance, deviations.signed_mm[i]);
    const double guard_mm = kGuardFactor * uncertainty_mm[i];
    on_surfaces_mm.push_back(deviations.signed_mm[i]);
    left_out.push_back(deviations.outliers.is_outlier[i]);
    if (left_out.back()) {
      ++result.outliers;
      outliers_outside += outside_mm > -guard_mm;
      continue;
    }
    bad += outside_mm > guard_mm;
    doubtful += outside_mm > -guard_mm && outside_mm <= guard_mm;
    if (outside_mm > worst.excess_mm) worst = {outside_mm, guard_mm};
  }
  const DeviationStatistics statistics = statistics_of(on_surfaces_mm, left_out);
  result.min_mm = statistics.min_mm;
  result.max_mm = statistics.max_mm;
  result.counts = count_against(on_surfaces_mm, left_out, tolerance);
  if (result.points > result.outliers) {
    result.guard_mm = worst.guard_mm;
    result.profile_mm = 2.0 * worst.excess_mm + (tolerance.upper_mm - tolerance.lower_mm);
  }
  decide(result, bad, doubtful, outliers_outside);
  return result;
}

}  // namespace trueblade
