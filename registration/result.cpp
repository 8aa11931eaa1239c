#include "registration/result.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace trueblade {
namespace {

constexpr double kDegreesPerRad = 180.0 / 3.14159265358979323846;

std::string words_for(Termination termination) {
  switch (termination) {
    case Termination::converged_statistically:
      return "the step is small against the pose's own uncertainty";
    case Termination::converged_rms:
      return "the RMS no longer changes";
    case Termination::converged_step:
      return "the step is shorter than the threshold";
    case Termination::iteration_limit:
      return "the iteration limit was reached without convergence";
    case Termination::no_descent:
      return "no step lowers the objective any further";
    case Termination::too_few_correspondences:
      return "too few correspondences are left for a pose";
  }
  return "?";
}

}  // namespace

std::string to_string(Termination termination) {
  switch (termination) {
    case Termination::converged_statistically:
      return "converged_statistically";
    case Termination::converged_rms:
      return "converged_rms";
    case Termination::converged_step:
      return "converged_step";
    case Termination::iteration_limit:
      return "iteration_limit";
    case Termination::no_descent:
      return "no_descent";
    case Termination::too_few_correspondences:
      return "too_few_correspondences";
  }
  return "?";
}

bool is_converged(Termination termination) {
  return termination == Termination::converged_statistically || termination == Termination::converged_rms ||
         termination == Termination::converged_step;
}

std::string brief_report(const RegistrationResult& result) {
  return fmt::format(
      "{} after {} iterations: RMS {:.6f} mm of {} points ({} rejected), {:.6f} mm before{}",
      to_string(result.termination), result.iterations, result.rms_mm, result.inliers, result.outliers,
      result.first_rms_mm,
      result.undetermined.empty() ? "" : fmt::format("; {} undetermined", result.undetermined.size()));
}

std::string full_report(const RegistrationResult& result) {
  const auto& q = result.part_from_mcs.rotation;
  const Vec3& t = result.part_from_mcs.translation_mm;
  const Vec6 deviation = result.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  std::string text;
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<28}{}\n", name, value);
  };
  line("termination", fmt::format("{}: {}", to_string(result.termination), words_for(result.termination)));
  line("iterations", fmt::format("{}", result.iterations));
  line("inliers, outliers", fmt::format("{}, {}", result.inliers, result.outliers));
  line("RMS before, after (mm)", fmt::format("{:.6f}, {:.6f}", result.first_rms_mm, result.rms_mm));
  line("weighted RMS (mm)", fmt::format("{:.6f}", result.weighted_rms_mm));
  line("rotation w, x, y, z", fmt::format("{:.12f}, {:.12f}, {:.12f}, {:.12f}", q.w(), q.x(), q.y(), q.z()));
  line("translation (mm)", fmt::format("{:.9f}, {:.9f}, {:.9f}", t.x(), t.y(), t.z()));
  line("sigma of a distance (mm)",
       fmt::format("{:.6g} ({})", result.sigma_mm, result.sigma_estimated ? "estimated" : "given"));
  line("std. dev. rotation (deg)", fmt::format("{:.3g}, {:.3g}, {:.3g}", kDegreesPerRad * deviation[0],
                                               kDegreesPerRad * deviation[1], kDegreesPerRad * deviation[2]));
  line("std. dev. at centroid (mm)",
       fmt::format("{:.3g}, {:.3g}, {:.3g}", deviation[3], deviation[4], deviation[5]));
  for (const UndeterminedDirection& direction : result.undetermined)
    line("not determined, not moved", direction.words);
  line("closest points",
       fmt::format("{} queries, {:.1f} % from the cache, {:.1f} facets per query", result.work.queries,
                   100.0 * static_cast<double>(result.work.cache_hits) /
                       std::max<double>(1.0, static_cast<double>(result.work.queries)),
                   static_cast<double>(result.work.facets_tested) /
                       std::max<double>(1.0, static_cast<double>(result.work.queries))));
  if (result.cross_check) line("cross-check by Ceres", result.cross_check->summary);
  return text;
}

}  // namespace trueblade
