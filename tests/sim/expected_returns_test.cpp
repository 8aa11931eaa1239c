// What a plan says of missing returns is what the simulated machine then measures; the limit is the closed
// form of the mean signal.
#include "sim/expected_returns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hardware/execute_plan.h"
#include "hardware/plan_view.h"
#include "sim/simulated_machine.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A ball seen up to 60 degrees of incidence, matt: signal = cos(incidence).
struct Scene {
  Scene() {
    setup.lens = standard_lens("25mm");
    setup.geometry.stage_from_probe_at_zero.translation_mm = {0.0, 50.0, 0.0};
    setup.sensor = perfect_sensor();
    setup.sensor.speckle = 0.0;
    options.max_incidence_rad = 60.0 * kDegree;
    options.spacing_mm = 0.42;  // 58 columns: none on an edge of the facets
    plan = plan_view(setup.geometry, setup.lens, *part, *caster, {}, options);
  }
  // SNR = c^2 / (c^2 + k^2) reaches missed_snr at this incidence.
  void let_return_up_to(double incidence_rad) {
    const double snr = setup.sensor.missed_snr;
    setup.sensor.noise_to_signal = std::cos(incidence_rad) * std::sqrt((1.0 - snr) / snr);
  }
  std::size_t points_beyond(double incidence_rad) const {
    std::size_t count = 0;
    for (const PlannedPoint& point : plan.points)
      count += point.incidence_cosine < std::cos(incidence_rad) ? 1 : 0;
    return count;
  }
  ExpectedReturns expected() const { return expected_returns(plan, setup.sensor, setup.lens); }

  std::shared_ptr<Part> part = std::make_shared<Part>(testing::sphere(12.0));
  std::shared_ptr<RayCaster> caster = std::make_shared<RayCaster>(part->model);
  VirtualSetup setup;
  PlanOptions options;
  ScanPlan plan;
};

TEST(ExpectedReturns, AreThoseOfTheMeasurement) {
  Scene scene;
  scene.let_return_up_to(40.0 * kDegree);
  const ExpectedReturns expected = scene.expected();
  EXPECT_EQ(expected.points, scene.plan.point_count());
  EXPECT_EQ(expected.too_weak, scene.points_beyond(40.0 * kDegree));
  EXPECT_EQ(expected.beyond_incidence, 0u);
  EXPECT_GT(expected.too_weak, 100u);
  EXPECT_GT(expected.returning(), 100u);

  SimulatedMachine machine(make_virtual_part(scene.part, scene.caster), scene.setup);
  const ViewScan scan = execute_plan(machine, scene.setup.geometry, scene.plan);
  EXPECT_EQ(scan.usable.size(), expected.returning());
  EXPECT_NE(
      missing_returns(expected, scene.setup.sensor, scene.setup.lens).find("with an SNR below missed_snr"),
      std::string::npos);
}

TEST(ExpectedReturns, TheLensLimitsTheIncidence) {
  Scene scene;
  scene.setup.lens.max_incidence_rad = 30.0 * kDegree;
  const ExpectedReturns expected = scene.expected();
  EXPECT_EQ(expected.beyond_incidence, scene.points_beyond(30.0 * kDegree));
  EXPECT_EQ(expected.too_weak, 0u);
  EXPECT_NE(missing_returns(expected, scene.setup.sensor, scene.setup.lens)
                .find("beyond the lens's incidence of 30.0"),
            std::string::npos);
}

TEST(ExpectedReturns, NothingIsSaidWhenAllReturn) {
  const Scene scene;
  const ExpectedReturns expected = scene.expected();
  EXPECT_EQ(expected.returning(), expected.points);
  EXPECT_EQ(missing_returns(expected, scene.setup.sensor, scene.setup.lens), "");
}

}  // namespace
}  // namespace trueblade
