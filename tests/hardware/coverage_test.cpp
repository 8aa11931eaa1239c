// Access, coverage and choice of views on parts where they are known: a sphere, a plate, a groove.
#include "hardware/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "hardware/coverage_report.h"
#include "hardware/view_angles.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

TEST(Coverage, SamplesStandForTheWholeAreaAndLieOnTheirSurfaces) {
  const Part part = testing::plate(2.0, 10.0);
  const auto samples = sample_surfaces(part, {}, 1000);
  double area = 0.0;
  Vec3 middle = Vec3::Zero();
  for (const SurfaceSample& sample : samples) {
    area += sample.area_mm2;
    middle += sample.area_mm2 * sample.point_mm;
    EXPECT_NEAR(sample.point_mm.y(), 2.0, 1e-12);
    EXPECT_EQ(sample.surface, sample.point_mm.x() < 0.0 ? 0u : 1u);
  }
  EXPECT_NEAR(area, 100.0, 1e-9);
  // 1000 samples spread at random over 10 mm would have a mean within 2.9 mm / sqrt(1000) = 0.09 mm, one
  // standard error; these are spread more evenly.
  EXPECT_LT((middle / area - Vec3(0.0, 2.0, 0.0)).norm(), 0.2);
  EXPECT_EQ(sample_surfaces(part, std::vector<std::uint32_t>{1}, 10).size(), 16u);
}

// The share of a sphere within an angle of the pole that faces the sensor is (1 - cos) / 2.
TEST(Coverage, OfASphereTheCapWithinTheIncidenceLimitIsSeen) {
  const Part part = testing::sphere(10.0, 90);
  const RayCaster caster(part.model);
  const ProbeBody body;
  const ProbeClearance clearance(part.model, body);
  const AccessCheck access(caster, clearance, standard_lens("25mm"), body, 60.0 * kDegree);
  const auto samples = sample_surfaces(part, {}, 10'000);
  const std::vector<double> theta{0.7};
  const std::vector<std::vector<PointAccess>> from{access_from_angle({}, {}, theta[0], access, samples)};
  const Coverage coverage = summarise_coverage(theta, samples, from);
  ASSERT_EQ(coverage.surfaces.size(), 1u);
  // Flat facets of 2 degrees blur the limits by a degree, d(share) = sin(60 deg) / 2 * 1 deg = 0.008; samples
  // add sqrt(0.25 * 0.75 / 10000) = 0.004 at most.
  const auto share = [&](PointAccess reason) {
    return coverage.surfaces[0].by_access[static_cast<std::size_t>(reason)];
  };
  EXPECT_NEAR(coverage.seen, 0.25, 0.012);
  EXPECT_NEAR(share(PointAccess::grazing), 0.25, 0.012);
  EXPECT_NEAR(share(PointAccess::facing_away), 0.5, 0.012);
  EXPECT_EQ(share(PointAccess::hidden), 0.0);
}

TEST(PointAccess, EachReasonIsFoundWhereItHolds) {
  const Part part = testing::plate_with_wall(30.0);
  const RayCaster caster(part.model);
  const ProbeBody body{.radius_mm = 4.0, .length_mm = 100.0, .aperture_radius_mm = 3.0, .clearance_mm = 0.5};
  const ProbeClearance clearance(part.model, body);
  const Lens lens = standard_lens("25mm");
  const AccessCheck access(caster, clearance, lens, body, 60.0 * kDegree);
  const Vec3 down = -Vec3::UnitY();
  EXPECT_EQ(access.check({-10, 0, 0}, Vec3::UnitY(), down), PointAccess::measurable);
  EXPECT_EQ(access.check({-10, 0, 0}, Vec3::UnitY(), -down), PointAccess::facing_away);
  const Vec3 slanted(std::sin(65.0 * kDegree), -std::cos(65.0 * kDegree), 0.0);
  EXPECT_EQ(access.check({-10, 0, 0}, Vec3::UnitY(), slanted), PointAccess::grazing);
  // From the other side of the wall at 50 degrees.
  const Vec3 over_wall(-std::sin(50.0 * kDegree), -std::cos(50.0 * kDegree), 0.0);
  EXPECT_EQ(access.check({5, 0, 0}, Vec3::UnitY(), over_wall), PointAccess::hidden);
  // 0.2 mm beside the wall, which is higher than the standoff: the half of the light on the wall's side is
  // cut off, which is allowed; the housing at 25 mm would be in the wall.
  EXPECT_EQ(access.check({9.8, 0, 0}, Vec3::UnitY(), down), PointAccess::probe_touches);
  // 4.6 mm beside it the housing of 4 mm radius and 0.5 mm clearance passes.
  EXPECT_EQ(access.check({5.4, 0, 0}, Vec3::UnitY(), down), PointAccess::measurable);
  EXPECT_EQ(access.check({5.6, 0, 0}, Vec3::UnitY(), down), PointAccess::probe_touches);
}

TEST(PointAccess, InASlotNarrowerThanTheLightMoreThanHalfIsCutOff) {
  // Two walls 1 mm apart, 20 mm high: of the eight rays of a 3 mm aperture at 25 mm, those that leave the
  // slot by more than 0.5 mm before its top are cut; only the two along it pass.
  FacetSoup soup;
  for (const double x : {-0.5, 0.5}) {
    const auto n = static_cast<std::uint32_t>(soup.nodes_mm.size());
    soup.nodes_mm.insert(soup.nodes_mm.end(), {{x, 0, -20}, {x, 0, 20}, {x, 20, 20}, {x, 20, -20}});
    soup.facets.push_back({n, n + 1, n + 2});
    soup.facets.push_back({n, n + 2, n + 3});
  }
  const Part part = testing::part_of(soup);
  const RayCaster caster(part.model);
  const ProbeBody body{.radius_mm = 3.0, .length_mm = 100.0, .aperture_radius_mm = 3.0, .clearance_mm = 0.5};
  const ProbeClearance clearance(part.model, body);
  const AccessCheck access(caster, clearance, standard_lens("25mm"), body, 60.0 * kDegree);
  EXPECT_EQ(access.check({0, 0, 0}, Vec3::UnitY(), -Vec3::UnitY()), PointAccess::beam_blocked);
}

TEST(ViewAngles, ASphereNeedsThreeViewsAt60Degrees) {
  // Within 60 degrees of incidence each view sees a cap of 120 degrees of the equator: of candidates 120
  // degrees apart all three are needed.
  const Part part = testing::sphere(10.0, 60);
  const RayCaster caster(part.model);
  PlanOptions plan;
  plan.max_incidence_rad = 60.0 * kDegree;
  ViewAngleOptions options;
  options.candidate_step_rad = 120.0 * kDegree;
  options.least_gain = 0.05;
  const AxisLimits limits{{-500, -500, -500, -10}, {500, 500, 500, 10}};
  const ViewChoice choice =
      choose_view_angles({}, standard_lens("25mm"), limits, part, caster, {}, plan, options);
  ASSERT_EQ(choice.theta_rad.size(), 3u);
  EXPECT_NEAR(choice.coverage.seen, 0.75, 0.03);  // three caps of a quarter each, touching
  EXPECT_LE(choice.coverage.seen, choice.coverable);
  const Coverage again = coverage_of_views({}, standard_lens("25mm"), part, caster, {}, plan,
                                           choice.theta_rad, options.sample_count);
  EXPECT_EQ(again.seen, choice.coverage.seen);
}

TEST(ViewAngles, OnlyAnglesWithinTheTravelAreCandidates) {
  const Part part = testing::sphere(10.0, 30);
  const RayCaster caster(part.model);
  const AxisLimits limits{{-500, -500, -500, -1.0}, {500, 500, 500, 0.6}};
  const ViewChoice choice = choose_view_angles({}, standard_lens("25mm"), limits, part, caster, {}, {}, {});
  ASSERT_FALSE(choice.theta_rad.empty());
  for (const double theta : choice.theta_rad) {
    EXPECT_GE(theta, -1.0);
    EXPECT_LE(theta, 0.6);
  }
}

TEST(ViewAngles, APlateIsSeenFromOneSideAndAnInvisibleOneIsAnError) {
  const Part part = testing::plate(0.0, 10.0);
  const RayCaster caster(part.model);
  const AxisLimits limits{{-500, -500, -500, -10}, {500, 500, 500, 10}};
  const ViewChoice choice = choose_view_angles({}, standard_lens("25mm"), limits, part, caster, {}, {}, {});
  EXPECT_EQ(choice.theta_rad.size(), 1u);
  EXPECT_EQ(choice.coverage.seen, 1.0);
  const AxisLimits behind{{-500, -500, -500, 3.0}, {500, 500, 500, 3.2}};
  EXPECT_THROW(choose_view_angles({}, standard_lens("25mm"), behind, part, caster, {}, {}, {}), InputError);
}

TEST(CoverageReport, NamesSurfacesViewsAndReasons) {
  const Part part = testing::plate(0.0, 10.0);
  const RayCaster caster(part.model);
  const std::vector<double> theta{0.0, kPi};
  const Coverage coverage = coverage_of_views({}, standard_lens("25mm"), part, caster, {}, {}, theta, 1000);
  const std::string table = coverage_table(coverage, part);
  EXPECT_NE(table.find("180 deg"), std::string::npos);
  EXPECT_NE(table.find("2 views see 100.0 % of the area of 2 surfaces"), std::string::npos);
  const std::string svg = coverage_svg(coverage, part);
  const Coverage of_one_view =
      coverage_of_views({}, standard_lens("25mm"), part, caster, {}, {}, std::vector<double>{0.0}, 1000);
  EXPECT_TRUE(coverage_words(of_one_view).starts_with("1 view sees ")) << coverage_words(of_one_view);
  EXPECT_EQ(svg.find("<svg"), 0u);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_NE(svg.find("faces away"), std::string::npos);
}

}  // namespace
}  // namespace trueblade
