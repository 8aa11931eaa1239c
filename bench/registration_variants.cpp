// Every published variant of the registration on the paper's kind of scan: one view of a blade, 25 mm lens
// (3 um), fixture error giving about 0.22 mm RMS before. On a part file, or on an analytic blade without one.
//
//   registration_variants [PART UNIT]
#include <fmt/format.h>
#include <tbb/global_control.h>

#include "part/part.h"
#include "registration/compare_variants.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

void compare(const std::string& name, const Part& part, std::size_t points, const Vec3& view) {
  const RigidTransform truth = shapes::some_pose();
  const auto ideal = shapes::points_on(part, points, view, 0.003, 1);
  const ScanPoints scan = shapes::seen_from(truth, ideal);
  const RigidTransform start =
      shapes::displaced(truth, 0.3, 0.3 * shapes::kPi / 180.0, shapes::centroid_of(ideal), 2);
  const RegistrationTarget target(part);
  const auto results = compare_variants(target, scan, start, truth);
  fmt::print("## {}: {} facets, {} points, RMS before {:.3f} mm, one thread\n\n{}\n", name,
             part.model.facet_count(), points, results.front().result.initial_rms_mm,
             variants_table(results));
}

}  // namespace
}  // namespace trueblade

int main(int argc, char** argv) {
  using namespace trueblade;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  if (argc == 3) {
    PartOptions options;
    options.unit = parse_length_unit(argv[2]);
    compare(argv[1], read_part(argv[1], options), 3400, Vec3(0.3, 1.0, 0.4));
    return 0;
  }
  const Part part = shapes::blade(96, 88);
  compare("analytic blade, simulated case", part, 1500, Vec3(0.3, 1.0, 0.4));
  compare("analytic blade, front view", part, 3354, Vec3(0.3, 1.0, 0.4));
  return 0;
}
