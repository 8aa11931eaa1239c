// Form errors: each field in closed form where it is simple, moments and correlation of the random one, and
// the deformed facet model against the field.
#include "sim/form_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/closest_point_tree.h"
#include "geometry/error.h"
#include "sim/deform_model.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 displaced(const FormError& error, const Vec3& p, const Vec3& normal = Vec3::UnitX()) {
  return DisplacementField({error}, 1, 0).displacement_mm(p, normal);
}

const StackingAxis kAxis{
    .point_mm = Vec3(1.0, 0.0, 0.0), .direction = Vec3::UnitZ(), .root_mm = 10.0, .tip_mm = 50.0};

TEST(FormErrors, TwistTurnsSectionsInProportionToHeight) {
  const AirfoilTwist twist{kAxis, 0.02};
  EXPECT_LT(displaced(twist, {6.0, 0.0, 5.0}).norm(), 1e-15);  // below the root
  const Vec3 half = displaced(twist, {6.0, 0.0, 30.0});        // 5 mm from the axis, half the height
  EXPECT_LT((half - Vec3(5.0 * (std::cos(0.01) - 1.0), 5.0 * std::sin(0.01), 0.0)).norm(), 1e-14);
  EXPECT_NEAR(displaced(twist, {6.0, 0.0, 90.0}).y(), 5.0 * std::sin(0.02), 1e-14);  // beyond the tip
}

TEST(FormErrors, BendGrowsWithTheSquareAndBowIsHighestInTheMiddle) {
  const AirfoilBend bend{kAxis, {0.0, 0.4, 0.0}};
  EXPECT_NEAR(displaced(bend, {0, 0, 30}).y(), 0.1, 1e-15);
  EXPECT_NEAR(displaced(bend, {0, 0, 50}).y(), 0.4, 1e-15);
  const AirfoilBow bow{kAxis, {0.0, 0.4, 0.0}};
  EXPECT_NEAR(displaced(bow, {0, 0, 30}).y(), 0.4, 1e-15);
  EXPECT_NEAR(displaced(bow, {0, 0, 20}).y(), 0.3, 1e-15);  // 4 * 1/4 * 3/4
  EXPECT_NEAR(displaced(bow, {0, 0, 50}).y(), 0.0, 1e-15);
}

TEST(FormErrors, APlatformShiftMovesWhatIsBelowAndFadesAbove) {
  const PlatformShift shift{Vec3::Zero(), Vec3::UnitZ(), 10.0, 2.0, {0.2, 0.0, 0.0}};
  EXPECT_EQ(displaced(shift, {0, 0, 3}).x(), 0.2);
  EXPECT_EQ(displaced(shift, {0, 0, 10}).x(), 0.2);
  EXPECT_NEAR(displaced(shift, {0, 0, 11}).x(), 0.1, 1e-15);
  EXPECT_EQ(displaced(shift, {0, 0, 12}).x(), 0.0);
}

TEST(FormErrors, APatchRisesOnTheSideItFaces) {
  const SurfacePatch patch{Vec3::Zero(), Vec3::UnitX(), 4.0, 0.1};
  EXPECT_NEAR(displaced(patch, {0, 0, 0}).x(), 0.1, 1e-15);
  EXPECT_NEAR(displaced(patch, {0, 2, 0}).x(), 0.05, 1e-15);
  EXPECT_EQ(displaced(patch, {0, 4, 0}).x(), 0.0);
  EXPECT_EQ(displaced(patch, {0, 0, 0}, -Vec3::UnitX()).norm(), 0.0);  // the far side of a thin wall
}

TEST(FormErrors, AWornEdgeRecedesAlongItsLine) {
  const WornEdge worn{{0, 0, 0}, {0, 0, 10}, -Vec3::UnitY(), 2.0, 0.3};
  EXPECT_NEAR((displaced(worn, {0, 0, 5}) - Vec3(0, -0.3, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((displaced(worn, {1, 0, 5}) - Vec3(0, -0.15, 0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(displaced(worn, {0, 0, 12.5}).norm(), 0.0);
}

TEST(FormErrors, ARandomFieldHasItsAmplitudeAndCorrelation) {
  const double amplitude = 0.02, length = 5.0;
  // Over trials: each gives one value at two points one correlation length apart.
  constexpr int kTrials = 4000;
  double mean = 0.0, square = 0.0, product = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const DisplacementField field({RandomForm{amplitude, length}}, 9, static_cast<std::uint64_t>(trial));
    const double a = field.displacement_mm({10, 20, 30}, Vec3::UnitX()).x() / amplitude;
    const double b = field.displacement_mm({10, 25, 30}, Vec3::UnitX()).x() / amplitude;
    mean += a;
    square += a * a;
    product += a * b;
  }
  const double n = kTrials;
  const double correlation = std::exp(-0.5);
  EXPECT_NEAR(mean / n, 0.0, 4.0 / std::sqrt(n));
  EXPECT_NEAR(square / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  // Var(ab) = 1 + correlation^2 for normal a, b.
  EXPECT_NEAR(product / n, correlation, 4.0 * std::sqrt((1.0 + correlation * correlation) / n));
}

TEST(FormErrors, ImpossibleValuesAreRefusedByKind) {
  const auto message_of = [](const FormError& error) -> std::string {
    try {
      validate({error});
    } catch (const InputError& failure) {
      return failure.what();
    }
    return "";
  };
  EXPECT_EQ(message_of(AirfoilTwist{kAxis, 0.1}), "");
  EXPECT_NE(message_of(AirfoilTwist{{.root_mm = 5.0, .tip_mm = 5.0}, 0.1}).find("twist"), std::string::npos);
  EXPECT_NE(message_of(SurfacePatch{Vec3::Zero(), {0, 0, 2}, 1.0, 0.1}).find("outward"), std::string::npos);
  EXPECT_NE(message_of(SurfacePatch{Vec3::Zero(), Vec3::UnitX(), 0.0, 0.1}).find("radius_mm"),
            std::string::npos);
  EXPECT_NE(message_of(RandomForm{-1.0, 1.0}).find("amplitude_mm"), std::string::npos);
  EXPECT_NE(message_of(PlatformShift{.blend_mm = 0.0}).find("blend_mm"), std::string::npos);
  EXPECT_NE(message_of(WornEdge{Vec3::Zero(), Vec3::Zero(), Vec3::UnitX(), 1.0, 0.1}).find("worn_edge"),
            std::string::npos);
}

TEST(DeformModel, ADentOnACoarsePlateIsFollowedByRefinedFacets) {
  // Two facets only: without refinement the dent would vanish.
  const Part part = testing::plate(0.0, 40.0, 1);
  const SurfacePatch dent{Vec3::Zero(), Vec3::UnitY(), 6.0, -0.2};
  const DisplacementField field({dent}, 1, 0);
  const DeformedModel deformed = deform_model(part.model, field);
  ASSERT_EQ(deformed.nominal_facet.size(), deformed.model.facet_count());
  // The surface at (x, z) is at the raised cosine; facets with edges of a tenth of the diameter follow it
  // within L^2 / 8 times its curvature 0.2 (pi / 6)^2 / 2, L = 1.2: 0.005 mm.
  const ClosestPointTree tree(deformed.model);
  for (double x = -9.0; x <= 9.0; x += 0.37)
    for (double z = -9.0; z <= 9.0; z += 0.41) {
      const double r = std::hypot(x, z);
      const double y = r < 6.0 ? -0.1 * (1.0 + std::cos(kPi * r / 6.0)) : 0.0;
      EXPECT_LT(tree.query({x, y, z}).distance_mm, 0.005) << x << " " << z;
    }
  EXPECT_NEAR(deformed.model.lower_corner_mm().y(), -0.2, 0.005);
}

TEST(DeformModel, SaysWhetherAnythingMoves) {
  const Part part = testing::plate(0.0, 40.0, 1);
  const auto displaced = [&](double beside_mm, double height_mm) {
    const SurfacePatch patch{{0.0, beside_mm, 0.0}, Vec3::UnitY(), 6.0, height_mm};
    return deform_model(part.model, DisplacementField({patch}, 1, 0)).displaced;
  };
  EXPECT_TRUE(displaced(0.0, 0.1));
  EXPECT_FALSE(displaced(7.0, 0.1));  // its sphere ends before the plate
  EXPECT_FALSE(displaced(0.0, 0.0));
}

TEST(DeformModel, RefinementOpensNoCracks) {
  const Part part = testing::sphere(20.0, 12);
  ASSERT_TRUE(part.report.closed);
  FormErrors errors{SurfacePatch{{20, 0, 0}, Vec3::UnitX(), 3.0, 0.1}, RandomForm{0.01, 8.0}};
  const DeformedModel deformed = deform_model(part.model, DisplacementField(errors, 1, 0));
  EXPECT_GT(deformed.model.facet_count(), 2 * part.model.facet_count());
  FacetSoup soup;
  for (std::uint32_t n = 0; n < deformed.model.node_count(); ++n)
    soup.nodes_mm.push_back(deformed.model.node_mm(n));
  for (std::uint32_t f = 0; f < deformed.model.facet_count(); ++f)
    soup.facets.push_back(deformed.model.facet_nodes(f));
  EXPECT_TRUE(build_facet_model(soup, 0.0).report.closed);
}

TEST(DeformModel, AShiftOfEverythingIsATranslation) {
  const Part part = testing::sphere(10.0, 20);
  const PlatformShift all{Vec3::Zero(), Vec3::UnitZ(), 100.0, 1.0, {0.1, 0.2, 0.3}};
  const DeformedModel deformed = deform_model(part.model, DisplacementField({all}, 1, 0));
  ASSERT_EQ(deformed.model.node_count(), part.model.node_count());
  for (std::uint32_t n = 0; n < part.model.node_count(); ++n)
    EXPECT_LT((deformed.model.node_mm(n) - part.model.node_mm(n) - Vec3(0.1, 0.2, 0.3)).norm(), 1e-14);
}

TEST(DeformModel, DetailsTooFineForThePartAreRefused) {
  const Part part = testing::plate(0.0, 1000.0, 1);
  EXPECT_THROW(deform_model(part.model, DisplacementField({RandomForm{0.1, 0.01}}, 1, 0)), InputError);
}

}  // namespace
}  // namespace trueblade
