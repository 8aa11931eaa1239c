// Profile of a surface (ISO 1101, ASME Y14.5) with the decision of ISO 14253-1: a part is conforming or not
// only where the measurement uncertainty leaves no doubt.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "inspection/deviations.h"
#include "inspection/tolerance.h"
#include "part/part.h"

namespace trueblade {

struct ProfileCallout {
  std::string name;
  std::vector<std::uint32_t> surfaces;  // CAD surfaces; empty: all
  Tolerance tolerance{-0.05, 0.05};
};

enum class Conformity { conforming, not_conforming, cannot_tell };
std::string to_string(Conformity conformity);

struct ProfileResult {
  ProfileCallout callout;
  std::size_t points = 0;    // on the surfaces of the callout
  std::size_t outliers = 0;  // of them, by the report's rule
  double min_mm = kNoValue;  // without outliers
  double max_mm = kNoValue;
  // Twice the largest distance from the middle of the zone, to be compared with the zone's width.
  double profile_mm = kNoValue;
  double uncertainty_mm = kNoValue;  // standard, of profile_mm: twice that of the point farthest out
  // Guard bands at the point that decides: inside either limit to accept, outside it to reject.
  double guard_mm = kNoValue;
  double rejection_guard_mm = kNoValue;
  double rejection_factor = kNoValue;  // the latter in standard uncertainties: rejection_guard_factor
  ToleranceCounts counts;              // without outliers
  Conformity conformity = Conformity::cannot_tell;
  std::string reason;  // in words
};

// To accept: 1.65 standard uncertainties, one-sided 95 % of a normal distribution, the default of
// ISO 14253-1:2017. All points must keep it, so that their number makes it no less safe.
inline constexpr double kGuardFactor = 1.65;

// To reject, where one of n points is enough: z with Phi(z)^n = 0.95. Noise alone carries the largest of n
// points on a limit beyond z u in 5 % of all measurements (errors that the points share, as the pose's, make
// it fewer). 1.645 for one point, 4.04 for 1,936. Of no point: NaN.
double rejection_guard_factor(std::size_t points);

// A point conforms when its deviation lies inside the zone by at least the first guard band, and does not
// when it lies outside by more than the second. One point that does not conform decides; all must conform;
// else nothing can be told. Outliers cannot prove that a part is bad, and a part is not called good while
// they lie outside the zone: a defect may look like them.
// `uncertainty_mm`: standard uncertainty of every deviation. Throws InputError for a surface that the part
// does not have, or limits out of order.
ProfileResult evaluate_profile(const ProfileCallout& callout, const Part& part, const Deviations& deviations,
                               std::span<const double> uncertainty_mm);

}  // namespace trueblade
