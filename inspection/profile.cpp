#include "inspection/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "geometry/random.h"

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
  double uncertainty_mm = kNoValue;
};

std::size_t points_that_count(const ProfileCallout& callout, const Deviations& deviations) {
  std::size_t points = 0;
  for (std::size_t i = 0; i < deviations.size(); ++i)
    points += is_on(callout, deviations.surface[i]) && !deviations.outliers.is_outlier[i];
  return points;
}

void decide(ProfileResult& result, std::size_t bad, std::size_t doubtful, std::size_t outliers_outside) {
  if (result.points == result.outliers) {
    result.reason = "no point was measured on these surfaces";
  } else if (bad > 0) {
    result.conformity = Conformity::not_conforming;
    result.reason =
        fmt::format("{} of {} points lie outside the zone by more than {:.2f} standard uncertainties", bad,
                    result.points - result.outliers, result.rejection_factor);
  } else if (doubtful > 0) {
    result.reason = fmt::format(
        "{} of {} points lie less than {:.2f} standard uncertainties inside a limit or less than {:.2f} "
        "outside it",
        doubtful, result.points - result.outliers, kGuardFactor, result.rejection_factor);
  } else if (outliers_outside > 0) {
    result.reason = fmt::format("{} outliers lie outside the zone", outliers_outside);
  } else {
    result.conformity = Conformity::conforming;
    result.reason =
        fmt::format("all points lie inside the zone by at least {:.2f} standard uncertainties", kGuardFactor);
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

double rejection_guard_factor(std::size_t points) {
  if (points == 0) return kNoValue;
  return inverse_normal(std::pow(0.95, 1.0 / static_cast<double>(points)));
}

ProfileResult evaluate_profile(const ProfileCallout& callout, const Part& part, const Deviations& deviations,
                               std::span<const double> uncertainty_mm) {
  callout.tolerance.validate();
  check_surfaces(callout, part.surfaces.size());
  const Tolerance& tolerance = callout.tolerance;

  ProfileResult result;
  result.callout = callout;
  result.rejection_factor = rejection_guard_factor(points_that_count(callout, deviations));
  std::vector<double> on_surfaces_mm;
  std::vector<bool> left_out;
  std::size_t bad = 0, doubtful = 0, outliers_outside = 0;
  Worst worst;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    if (!is_on(callout, deviations.surface[i])) continue;
    ++result.points;
    const double outside_mm = excess_mm(tolerance, deviations.signed_mm[i]);
    const double acceptance_mm = kGuardFactor * uncertainty_mm[i];
    const double rejection_mm = result.rejection_factor * uncertainty_mm[i];
    on_surfaces_mm.push_back(deviations.signed_mm[i]);
    left_out.push_back(deviations.outliers.is_outlier[i]);
    if (left_out.back()) {
      ++result.outliers;
      outliers_outside += outside_mm > -acceptance_mm;
      continue;
    }
    bad += outside_mm > rejection_mm;
    doubtful += outside_mm > -acceptance_mm && outside_mm <= rejection_mm;
    if (outside_mm > worst.excess_mm) worst = {outside_mm, uncertainty_mm[i]};
  }
  const DeviationStatistics statistics = statistics_of(on_surfaces_mm, left_out);
  result.min_mm = statistics.min_mm;
  result.max_mm = statistics.max_mm;
  result.counts = count_against(on_surfaces_mm, left_out, tolerance);
  if (result.points > result.outliers) {
    result.guard_mm = kGuardFactor * worst.uncertainty_mm;
    result.rejection_guard_mm = result.rejection_factor * worst.uncertainty_mm;
    result.uncertainty_mm = 2.0 * worst.uncertainty_mm;
    result.profile_mm = 2.0 * worst.excess_mm + (tolerance.upper_mm - tolerance.lower_mm);
  }
  decide(result, bad, doubtful, outliers_outside);
  return result;
}

}  // namespace trueblade
