// How far from the part a registration may begin: rate of success and time over random starts at stated
// distances, of the default and of one iteration on all points. One thread; found means within 0.01 mm at the
// scan's centroid.
//
//   registration_starts [starts] [points]
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdlib>

#include "registration/register_scan.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

struct Outcome {
  int found = 0;
  double mean_ms = 0.0;
};

Outcome register_from(const RegistrationTarget& target, const ScanPoints& scan, const RigidTransform& truth,
                      double distance, int starts, const RegistrationOptions& options) {
  const Vec3 centroid_mcs_mm = shapes::centroid_of(scan.position_mcs_mm);
  Outcome outcome;
  for (int k = 0; k < starts; ++k) {
    const RigidTransform start =
        shapes::displaced(truth, distance, distance * shapes::kPi / 180.0, truth * centroid_mcs_mm,
                          100 + static_cast<std::uint64_t>(k));
    const auto begin = std::chrono::steady_clock::now();
    const RegistrationResult result = register_scan(target, scan, start, options);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    outcome.mean_ms += time.count() / starts;
    outcome.found += shapes::pose_error(result.part_from_mcs, truth, centroid_mcs_mm).centroid_mm < 0.01;
  }
  return outcome;
}

}  // namespace
}  // namespace trueblade

int main(int argc, char** argv) {
  using namespace trueblade;
  const int starts = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::size_t points = argc > 2 ? static_cast<std::size_t>(std::atoll(argv[2])) : 3400;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const Part part = shapes::blade(96, 88);
  const RegistrationTarget target(part);
  const RigidTransform truth = shapes::some_pose();
  const ScanPoints scan =
      shapes::seen_from(truth, shapes::points_on(part, points, Vec3(0.3, 1.0, 0.4), 0.003, 1));
  RegistrationOptions one_start = preset("default");
  one_start.sampling.points = 0;
  fmt::print("{} starts, {} points, {} facets\n\n| start | one start | default |\n|---|---|---|\n", starts,
             points, part.model.facet_count());
  for (const double distance : {1.0, 2.0, 3.0, 5.0, 8.0}) {
    fmt::print("| {0} mm, {0} deg |", distance);
    for (const RegistrationOptions& options : {one_start, preset("default")}) {
      const Outcome outcome = register_from(target, scan, truth, distance, starts, options);
      fmt::print(" {:.0f} %, {:.1f} ms |", 100.0 * outcome.found / starts, outcome.mean_ms);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  return 0;
}
