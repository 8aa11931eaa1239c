// Time of a whole registration: set-up of the target (search tree), then register_scan, on analytic blades of
// about 17,000, 174,000 and 867,000 facets; 3,400 to 1,000,000 points with 3 um noise; starts 0.2 mm + 0.2
// degrees and 3 mm + 3 degrees away. The best of several runs.
//
//   registration_speed [threads] [largest number of points]
#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdlib>
#include <ctime>

#include "registration/register_scan.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kSigma_mm = 0.003;
constexpr double kDegree = shapes::kPi / 180.0;

// Wall clock and processor time. On a machine with other work only the latter says what one thread needs.
struct Instant {
  double wall_ms, processor_ms;
};
Instant now() {
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double, std::milli>(wall).count(),
          1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
}

void measure(const Part& part, std::size_t count, double distance_mm, double angle_deg) {
  const RigidTransform truth = shapes::some_pose();
  const ScanPoints scan =
      shapes::seen_from(truth, shapes::points_on(part, count, Vec3(0.3, 1.0, 0.4), kSigma_mm, 1));
  const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
  const RigidTransform start =
      shapes::displaced(truth, distance_mm, angle_deg * kDegree, truth * centroid_mcs, 2);
  Instant set_up{1e300, 1e300}, registration{1e300, 1e300};
  double first_ms = 0.0;
  RegistrationResult result;
  const int runs = count > 200000 || part.model.facet_count() > 500000 ? 5 : 15;
  for (int run = 0; run < runs; ++run) {
    const Instant begin = now();
    const RegistrationTarget target(part);
    const Instant built = now();
    result = register_scan(target, scan, start, preset("default"));
    const Instant end = now();
    if (run == 0) first_ms = end.wall_ms - begin.wall_ms;
    set_up.wall_ms = std::min(set_up.wall_ms, built.wall_ms - begin.wall_ms);
    set_up.processor_ms = std::min(set_up.processor_ms, built.processor_ms - begin.processor_ms);
    registration.wall_ms = std::min(registration.wall_ms, end.wall_ms - built.wall_ms);
    registration.processor_ms = std::min(registration.processor_ms, end.processor_ms - built.processor_ms);
  }
  const auto error = shapes::pose_error(result.part_from_mcs, truth, centroid_mcs);
  fmt::print(
      "| {} | {} | {} mm, {} deg | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {:.0f} % | {:.2f} | {} "
      "|\n",
      part.model.facet_count(), count, distance_mm, angle_deg, set_up.wall_ms, registration.wall_ms,
      set_up.wall_ms + registration.wall_ms, set_up.processor_ms + registration.processor_ms, first_ms,
      result.iterations,
      100.0 * static_cast<double>(result.work.cache_hits) / static_cast<double>(result.work.queries),
      1e3 * error.centroid_mm, to_string(result.termination));
  std::fflush(stdout);
}

}  // namespace
}  // namespace trueblade

int main(int argc, char** argv) {
  using namespace trueblade;
  const std::size_t threads = argc > 1 ? static_cast<std::size_t>(std::atoll(argv[1])) : 1;
  const std::size_t most = argc > 2 ? static_cast<std::size_t>(std::atoll(argv[2])) : 1000000;
  const std::size_t most_facets = argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3])) : 1000000;
  constexpr int kAll = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kAll);
  mallopt(M_TRIM_THRESHOLD, kAll);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  fmt::print("{} thread(s), noise {} mm\n\n", threads, kSigma_mm);
  fmt::print(
      "| facets | points | start | set-up ms | registration ms | whole ms | processor ms | first run ms | "
      "iterations | from "
      "cache | "
      "centroid error um | stopped by |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [around, along] : {std::pair{96, 88}, std::pair{300, 288}, std::pair{660, 655}}) {
    const Part part = shapes::blade(around, along);
    if (part.model.facet_count() > most_facets) break;
    for (const std::size_t count : {3400UL, 100000UL, 1000000UL}) {
      if (count > most) continue;
      measure(part, count, 0.2, 0.2);
      measure(part, count, 3.0, 3.0);
    }
  }
  return 0;
}
