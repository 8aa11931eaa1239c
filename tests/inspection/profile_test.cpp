// Covers: counts against limits, the per-point uncertainty by closed form, the three decisions and their
// borders, outliers, unequal zones, surfaces without points and unknown surfaces, statistics per surface.
#include "inspection/profile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/error.h"
#include "geometry/random.h"
#include "inspection/deviation_uncertainty.h"
#include "inspection/surface_statistics.h"
#include "tests/inspection/fixtures.h"

namespace trueblade {
namespace {

Deviations with_deviations(const std::vector<double>& signed_mm) {
  Deviations d;
  d.point_mm.assign(signed_mm.size(), Vec3::Zero());
  d.nominal_mm = d.point_mm;
  d.normal.assign(signed_mm.size(), Vec3::UnitZ());
  d.signed_mm = d.from_facets_mm = signed_mm;
  d.facet.assign(signed_mm.size(), 0);
  d.surface.assign(signed_mm.size(), 0);
  d.outliers.is_outlier.assign(signed_mm.size(), false);
  return d;
}

TEST(Tolerance, CountsWithinOverAndUnder) {
  const ToleranceCounts c = count_against(std::vector{-0.2, -0.1, 0.0, 0.1, 0.3, 0.4, 9.0, 0.2},
                                          {0, 0, 0, 0, 0, 0, 1, 1}, {-0.1, 0.3});
  EXPECT_EQ(c.within, 4U);  // both limits included
  EXPECT_EQ(c.over, 1U);
  EXPECT_EQ(c.under, 1U);
  EXPECT_EQ(c.outliers_outside, 1U);
  EXPECT_DOUBLE_EQ(c.percent(c.within), 400.0 / 6.0);
  EXPECT_TRUE(std::isnan(ToleranceCounts{}.percent(0)));
  EXPECT_THROW((Tolerance{0.1, 0.1}.validate()), InputError);
  EXPECT_THROW((Tolerance{-INFINITY, 0.1}.validate()), InputError);
}

TEST(DeviationUncertainty, IsPointAndPose) {
  Deviations d = with_deviations({0.0, 0.0, 0.0});
  d.point_mm = {{1, 2, 3}, {11, 2, 3}, {1, 2, 23}};
  RegistrationResult r;
  r.centroid_part_mm = {1, 2, 3};
  r.covariance(1, 1) = 1e-8;  // rotation about y: 1e-4 rad
  r.covariance(5, 5) = 9e-6;  // translation along z: 3e-3 mm
  const std::vector<double> u = deviation_uncertainty_mm(d, r, 0.004);
  EXPECT_NEAR(u[0], 0.005, 1e-15);  // 3-4-5
  // 10 mm off along x: rotation about y moves it along z by 1e-3 mm.
  EXPECT_NEAR(u[1], std::sqrt(25e-6 + 1e-6), 1e-15);
  EXPECT_NEAR(u[2], 0.005, 1e-15);  // along the normal there is no arm
}

class Profile : public ::testing::Test {
 protected:
  ProfileResult evaluate(const std::vector<double>& signed_mm, double uncertainty_mm,
                         const Tolerance& tolerance = {-0.05, 0.05}) {
    return evaluate_profile({"form", {}, tolerance}, part, with_deviations(signed_mm),
                            std::vector<double>(signed_mm.size(), uncertainty_mm));
  }
  Part part = plate_part(1.0);
};

TEST_F(Profile, DecidesByTheGuardBand) {
  // Guard bands 0.0165 to accept, and for two points to reject: Phi^-1(sqrt(0.95)) = 1.9545, 0.019545.
  const double u = 0.01;
  EXPECT_EQ(evaluate({0.03, -0.03}, u).conformity, Conformity::conforming);
  EXPECT_EQ(evaluate({0.034, -0.03}, u).conformity, Conformity::cannot_tell);
  EXPECT_EQ(evaluate({0.06, 0.0}, u).conformity, Conformity::cannot_tell);
  EXPECT_EQ(evaluate({0.0695, 0.0}, u).conformity, Conformity::cannot_tell);
  EXPECT_EQ(evaluate({0.0696, 0.0}, u).conformity, Conformity::not_conforming);
  EXPECT_EQ(evaluate({-0.0696, 0.034}, u).conformity, Conformity::not_conforming);
  EXPECT_EQ(evaluate({0.05, -0.05}, 0.0).conformity, Conformity::conforming);
  EXPECT_EQ(evaluate({0.0500001, 0.0}, 0.0).conformity, Conformity::not_conforming);
}

// Phi(z)^n = 0.95, by the complementary error function.
TEST_F(Profile, TheGuardBandToRejectKnowsTheNumberOfPoints) {
  for (const std::size_t n : {1U, 2U, 1936U, 1000000U}) {
    const double z = rejection_guard_factor(n);
    const double beyond = 0.5 * std::erfc(z / std::sqrt(2.0));
    EXPECT_NEAR(std::exp(static_cast<double>(n) * std::log1p(-beyond)), 0.95, 1e-9) << n;
  }
  EXPECT_NEAR(rejection_guard_factor(1936), 4.0, 0.05);
  EXPECT_TRUE(std::isnan(rejection_guard_factor(0)));
  const ProfileResult result = evaluate({0.01, 0.0, 0.0}, 0.001);
  EXPECT_EQ(result.rejection_factor, rejection_guard_factor(3));
  EXPECT_DOUBLE_EQ(result.rejection_guard_mm, 0.001 * result.rejection_factor);
}

// A flat patch exactly on the limit: noise alone condemns it in 5 % of the measurements, 5 +- 2.2 of 100;
// more than 13 have a probability of 0.05 %. A patch of 20 points beyond the limit by 8 u is found every
// time, and the one on the limit is accepted never.
TEST_F(Profile, NoiseSeldomCondemnsAPerfectSurface) {
  constexpr std::size_t kPoints = 5000;
  constexpr double kNoise_mm = 0.003;
  int condemned = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng random(seed, 0, "noise");
    std::vector<double> signed_mm(kPoints);
    for (double& d : signed_mm) d = 0.05 + kNoise_mm * random.normal();
    const Conformity on_the_limit = evaluate(signed_mm, kNoise_mm).conformity;
    EXPECT_NE(on_the_limit, Conformity::conforming);
    condemned += on_the_limit == Conformity::not_conforming;
    for (std::size_t i = 0; i < 20; ++i) signed_mm[i] += 8.0 * kNoise_mm;
    EXPECT_EQ(evaluate(signed_mm, kNoise_mm).conformity, Conformity::not_conforming) << seed;
  }
  EXPECT_LE(condemned, 13);
  EXPECT_GE(condemned, 1);  // none has a probability of 0.6 %: the band is not wider than it need be
}

TEST_F(Profile, ValueIsTwiceTheLargestDistanceFromTheMiddle) {
  const ProfileResult equal = evaluate({0.02, -0.04, 0.01}, 0.001);
  EXPECT_NEAR(equal.profile_mm, 0.08, 1e-15);
  EXPECT_EQ(equal.min_mm, -0.04);
  EXPECT_EQ(equal.max_mm, 0.02);
  EXPECT_NEAR(equal.guard_mm, 0.00165, 1e-15);
  EXPECT_NEAR(equal.uncertainty_mm, 0.002, 1e-15);
  // Zone -0.02 to 0.08, middle 0.03: the point at -0.04 is 0.07 off.
  EXPECT_NEAR(evaluate({0.02, -0.04, 0.01}, 0.001, {-0.02, 0.08}).profile_mm, 0.14, 1e-15);
}

TEST_F(Profile, OutliersNeitherCondemnNorAreForgotten) {
  Deviations d = with_deviations({0.0, 0.01, 5.0});
  d.outliers.is_outlier[2] = true;
  const std::vector<double> u(3, 0.001);
  const ProfileResult result = evaluate_profile({"form", {}, {-0.05, 0.05}}, part, d, u);
  EXPECT_EQ(result.conformity, Conformity::cannot_tell);
  EXPECT_EQ(result.outliers, 1U);
  EXPECT_EQ(result.max_mm, 0.01);
  d.signed_mm[2] = 0.02;
  EXPECT_EQ(evaluate_profile({"form", {}, {-0.05, 0.05}}, part, d, u).conformity, Conformity::conforming);
}

TEST_F(Profile, TakesTheSurfacesItIsTold) {
  Deviations d = with_deviations({0.0, 0.2, 0.01});
  d.surface = {0, 1, 2};
  const std::vector<double> u(3, 0.001);
  EXPECT_EQ(evaluate_profile({"top", {0}, {-0.05, 0.05}}, part, d, u).conformity, Conformity::conforming);
  EXPECT_EQ(evaluate_profile({"both", {0, 1}, {-0.05, 0.05}}, part, d, u).conformity,
            Conformity::not_conforming);
  d.surface = {0, 0, 0};
  const ProfileResult none = evaluate_profile({"bottom", {1}, {-0.05, 0.05}}, part, d, u);
  EXPECT_EQ(none.conformity, Conformity::cannot_tell);
  EXPECT_EQ(none.points, 0U);
  EXPECT_TRUE(std::isnan(none.profile_mm));
  EXPECT_THROW(evaluate_profile({"far", {3}, {-0.05, 0.05}}, part, d, u), InputError);
}

TEST_F(Profile, StatisticsPerSurface) {
  Deviations d = with_deviations({0.1, 0.3, -0.2, 7.0});
  d.surface = {0, 0, 2, 2};
  d.outliers.is_outlier[3] = true;
  const auto surfaces = statistics_by_surface(part, d, std::nullopt);
  ASSERT_EQ(surfaces.size(), 2U);
  EXPECT_EQ(surfaces[0].name, "surface_0");
  EXPECT_NEAR(surfaces[0].statistics.mean_mm, 0.2, 1e-15);
  EXPECT_EQ(surfaces[1].surface, 2U);
  EXPECT_EQ(surfaces[1].statistics.points, 2U);
  EXPECT_EQ(surfaces[1].statistics.left_out, 1U);
  EXPECT_EQ(surfaces[1].statistics.max_mm, -0.2);
}

}  // namespace
}  // namespace trueblade
