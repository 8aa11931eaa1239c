// Every published variant of the registration on the paper's cases (Table 2): the demonstration blade of 102
// surfaces and the formed part of 165, front and back view with the paper's numbers of points, 25 mm lens (3
// um of noise), a fixture error of 0.2 mm and 0.2 degrees. The points lie on the CAD surfaces. One thread.
//
//   registration_variants
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>

#include "part/exact_closest_point.h"
#include "part/formed_part.h"
#include "part/turbine_blade.h"
#include "registration/compare_variants.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kSigma_mm = 0.003;
constexpr double kDegree = shapes::kPi / 180.0;

std::vector<Vec3> points_on_surfaces(const Part& part, const ClosestPointTree& tree, std::size_t count,
                                     const Vec3& view) {
  std::vector<Vec3> points;
  Rng rng(1, 0, "noise");
  for (const Vec3& p : shapes::points_on(part, count, view, 0.0, 1))
    if (const auto exact = refine_to_exact(part, tree.query(p), p))
      points.push_back(exact->foot.point_mm + kSigma_mm * rng.normal() * exact->foot.normal);
  return points;
}

double rms_mm(const ClosestPointTree& tree, const ScanPoints& scan, const RigidTransform& part_from_mcs) {
  double squares = 0.0;
  for (const Vec3& p : scan.position_mcs_mm) {
    const double distance = tree.query(part_from_mcs * p).distance_mm;
    squares += distance * distance;
  }
  return std::sqrt(squares / static_cast<double>(scan.size()));
}

void compare(const std::string& name, const RegistrationTarget& target, std::size_t count, const Vec3& view) {
  const RigidTransform truth = shapes::some_pose();
  const auto points = points_on_surfaces(target.part(), target.tree(), count, view);
  const ScanPoints scan = shapes::seen_from(truth, points);
  const RigidTransform start = shapes::displaced(truth, 0.2, 0.2 * kDegree, shapes::centroid_of(points), 2);
  const auto results = compare_variants(target, scan, start, truth);
  fmt::print("### {}: {} surfaces, {} facets, {} points, RMS before {:.3f} mm\n\n{}\n", name,
             target.part().surfaces.size(), target.model().facet_count(), scan.size(),
             rms_mm(target.tree(), scan, start), variants_table(results));
  std::fflush(stdout);
}

}  // namespace
}  // namespace trueblade

int main() {
  using namespace trueblade;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  {
    const Part blade = make_turbine_blade(TurbineBladeParameters{}, FacetingOptions{});
    const RegistrationTarget target(blade);
    compare("Simulated measurements", target, 1500, Vec3(0, -1, 0));
    compare("Turbine blade, front view", target, 3354, Vec3(0, -1, 0));
    compare("Turbine blade, back view", target, 3418, Vec3(0, 1, 0));
  }
  const Part formed = make_formed_part(FormedPartParameters{}, FacetingOptions{});
  const RegistrationTarget target(formed);
  compare("Formed part, front view", target, 2201, Vec3(0, 0, 1));
  compare("Formed part, back view", target, 2209, Vec3(0, 0, -1));
  return 0;
}
