// Distance of the housing, a capsule, to known parts; ways that are free and ways that are not.
#include "hardware/probe_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/error.h"
#include "geometry/random.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

const Vec3 kBeam = -Vec3::UnitY();

ProbeBody slim_body() {
  return {.radius_mm = 5.0, .length_mm = 50.0, .aperture_radius_mm = 2.0, .clearance_mm = 0.5};
}

TEST(ProbeBody, InFrontOfAPlateTheSpareIsTheDistanceOfTheOrigin) {
  const Part part = testing::plate(0.0, 200.0);
  const ProbeClearance clearance(part.model, slim_body());
  // The capsule's front end lies at the origin.
  EXPECT_NEAR(clearance.spare_mm({0.0, 7.0, 0.0}, kBeam, 100.0), 6.5, ProbeClearance::kResolutionMm);
  EXPECT_NEAR(clearance.spare_mm({0.0, 0.2, 0.0}, kBeam, 100.0), -0.3, ProbeClearance::kResolutionMm);
}

TEST(ProbeBody, BesideASphereTheSpareIsThatOfTheCapsulesAxis) {
  const double radius_mm = 10.0;
  const Part part = testing::sphere(radius_mm, 90);
  const ProbeClearance clearance(part.model, slim_body());
  Rng rng(1, 0, "origins");
  for (int k = 0; k < 200; ++k) {
    const Vec3 origin(30.0 * (rng.uniform() - 0.5), 80.0 * (rng.uniform() - 0.7),
                      30.0 * (rng.uniform() - 0.5));
    // Axis from 5 to 55 mm behind the origin, along +y.
    const double nearest_y = std::clamp(0.0, origin.y() + 5.0, origin.y() + 55.0);
    const double from_centre = Vec3(origin.x(), nearest_y, origin.z()).norm();
    if (from_centre < radius_mm) continue;  // inside: the distance to the surface says less
    const double exact = from_centre - radius_mm - 5.5;
    const double spare = clearance.spare_mm(origin, kBeam, 100.0);
    // Facets of 2 degrees lie inside the sphere by up to 2 * 10 (1 - cos 1 deg) = 0.003 mm. The march may
    // pass the nearest place by half its resolution, and so give up to that much more, never less.
    EXPECT_GT(spare, exact - 1e-9);
    EXPECT_LT(spare, exact + 0.5 * ProbeClearance::kResolutionMm + 0.003);
  }
}

TEST(ProbeBody, AWayAcrossASphereIsBlockedAndOneAroundItIsFree) {
  const Part part = testing::sphere(10.0);
  const ProbeClearance clearance(part.model, slim_body());
  EXPECT_FALSE(clearance.way_is_free({-40, 0, 0}, {40, 0, 0}, kBeam));
  // Beside it, the axis reaching from y = -15 to 35: free from 10 + 5.5 mm on.
  EXPECT_FALSE(clearance.way_is_free({-40, -20, 15.3}, {40, -20, 15.3}, kBeam));
  EXPECT_TRUE(clearance.way_is_free({-40, -20, 15.6}, {40, -20, 15.6}, kBeam));
  EXPECT_TRUE(clearance.way_is_free({-40, 11, 0}, {40, 11, 0}, kBeam));  // in front of it
  EXPECT_FALSE(clearance.way_is_free({0, 11, 0}, {0, 10, 0}, kBeam));
}

TEST(ProbeBody, AWayOfNoLengthIsThePlaceItself) {
  const Part part = testing::sphere(10.0);
  const ProbeClearance clearance(part.model, slim_body());
  EXPECT_TRUE(clearance.way_is_free({0, 11, 0}, {0, 11, 0}, kBeam));
  EXPECT_FALSE(clearance.way_is_free({0, 10.2, 0}, {0, 10.2, 0}, kBeam));
}

TEST(ProbeBody, ImpossibleBodiesAreRefused) {
  ProbeBody flat = slim_body();
  flat.radius_mm = 0.0;
  EXPECT_THROW(flat.validate(), InputError);
  ProbeBody wide = slim_body();
  wide.aperture_radius_mm = 6.0;
  EXPECT_THROW(wide.validate(), InputError);
  ProbeBody nan = slim_body();
  nan.length_mm = std::nan("");
  EXPECT_THROW(nan.validate(), InputError);
}

}  // namespace
}  // namespace trueblade
