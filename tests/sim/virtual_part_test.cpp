// The exact part under the beam, against closed forms: beside an edge the surface behind the facet may be the
// neighbour's, also where a form error moves the seam between them, and where facets stand out of the part
// the beam passes by.
#include "sim/virtual_part.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "tests/part/cad_files.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kChordMm = 0.05;  // five times the trimming margin

VirtualPart exact_part(TestShape shape, const FormErrors& form_errors = {}) {
  const TemporaryFolder folder;
  write_test_shape(shape, folder / "shape.step");
  PartOptions options;
  options.faceting.chord_tolerance_mm = kChordMm;
  const auto part = std::make_shared<const Part>(read_part(folder / "shape.step", options));
  const auto caster = std::make_shared<const RayCaster>(part->model);
  return make_virtual_part(part, caster, PartSurfaceMode::exact, form_errors, 1, 0);
}

// A cylinder of radius 5 from z = 0 to 12, seen from above at 45 degrees where its side meets its upper
// plane, `turns` times around. The polygon of the plane lies inside the circle by up to the chord tolerance:
// beams that pass it and meet the facets of the side meet, exactly, the plane. `look(hit, expected normal)`
// sees every hit; returns how many were on another surface than their facet's.
int beams_over_the_rim(const VirtualPart& part, int turns,
                       const std::function<void(const PartHit&, const Vec3&)>& look) {
  int met_the_neighbour = 0;
  for (int turn = 0; turn < turns; ++turn) {
    const double angle = 2.0 * std::numbers::pi / turns * (turn + 0.37);
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
    for (const double past_circle_mm : {-0.04, -0.02, -0.005, 0.005, 0.03}) {
      // The beam passes the plane z = 12 at this distance outside the circle.
      const double range_mm = 20.0;
      const Vec3 direction = (-outward - Vec3::UnitZ()).normalized();
      const Ray ray{(5.0 + past_circle_mm) * outward + 12.0 * Vec3::UnitZ() - range_mm * direction,
                    direction};
      const auto hit = first_hit(part, ray, kInfinity);
      EXPECT_TRUE(hit.has_value());
      if (!hit) continue;
      EXPECT_TRUE(hit->refined);
      // Outside the circle it goes on to the side, sqrt(2) times as far.
      const double expected_mm = range_mm + std::sqrt(2.0) * std::max(0.0, past_circle_mm);
      EXPECT_NEAR(hit->range_mm, expected_mm, 1e-8) << angle << " " << past_circle_mm;
      look(*hit, past_circle_mm < 0.0 ? Vec3(Vec3::UnitZ()) : outward);
      met_the_neighbour += hit->surface != part.model->surface_of(hit->facet) ? 1 : 0;
    }
  }
  return met_the_neighbour;
}

TEST(VirtualPart, BesideAnEdgeTheBeamMeetsTheNeighbouringSurface) {
  const int met_the_neighbour = beams_over_the_rim(
      exact_part(TestShape::cylinder), 720,
      [](const PartHit& hit, const Vec3& normal) { EXPECT_NEAR(hit.normal.dot(normal), 1.0, 1e-9); });
  EXPECT_GT(met_the_neighbour, 100);
}

// The same with a form error that is next to none: the whole cylinder is 1e-9 mm from where it was. The
// normal stays the facet's.
TEST(VirtualPart, BesideAnEdgeOfADisplacedPartTheBeamMeetsTheNeighbouringSurface) {
  PlatformShift shift;
  shift.top_mm = 100.0;
  shift.shift_mm = Vec3(1e-9, 0.0, 0.0);
  const int met_the_neighbour =
      beams_over_the_rim(exact_part(TestShape::cylinder, {shift}), 360, [](const PartHit&, const Vec3&) {});
  EXPECT_GT(met_the_neighbour, 50);
}

// A torus about z whose hole has radius 7: between the nodes its facets stand into the hole. A beam along the
// axis that meets them there meets no surface.
TEST(VirtualPart, WhereFacetsStandOutOfThePartTheBeamPassesBy) {
  const VirtualPart part = exact_part(TestShape::torus);
  int met_facets = 0;
  for (int turn = 0; turn < 720; ++turn) {
    const double angle = std::numbers::pi / 360.0 * (turn + 0.37);
    for (const double inside_hole_mm : {0.002, 0.01, 0.02, 0.04}) {
      const double r = 7.0 - inside_hole_mm;
      const Ray ray{{r * std::cos(angle), r * std::sin(angle), 20.0}, -Vec3::UnitZ()};
      EXPECT_FALSE(first_hit(part, ray, kInfinity).has_value()) << angle << " " << inside_hole_mm;
      met_facets += part.caster->first_hit(ray, 0.0, kInfinity).has_value() ? 1 : 0;
    }
    // On the material, half a millimetre from the hole: z = sqrt(9 - 2.5^2).
    const Ray onto{{7.5 * std::cos(angle), 7.5 * std::sin(angle), 20.0}, -Vec3::UnitZ()};
    const auto hit = first_hit(part, onto, kInfinity);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->range_mm, 20.0 - std::sqrt(9.0 - 2.5 * 2.5), 1e-8);
  }
  EXPECT_GT(met_facets, 100);
}

// Grazing the torus at its outer equator (radius 13), where the beam enters and leaves within a few facets:
// it meets the side that faces it, or, where no facet stands, nothing.
TEST(VirtualPart, AGrazingBeamMeetsTheSideThatFacesIt) {
  const VirtualPart part = exact_part(TestShape::torus);
  int met = 0;
  for (int turn = 0; turn < 3600; ++turn) {
    const double angle = std::numbers::pi / 1800.0 * (turn + 0.37);
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 along(-std::sin(angle), std::cos(angle), 0.0);
    for (const double inside_mm : {0.001, 0.01, 0.02, 0.03, 0.05, 0.08, 0.15}) {
      const double distance_mm = 13.0 - inside_mm;
      const Ray ray{distance_mm * outward - 20.0 * along, along};
      const auto hit = first_hit(part, ray, kInfinity);
      if (!hit) continue;
      ++met;
      const double half_chord_mm = std::sqrt(13.0 * 13.0 - distance_mm * distance_mm);
      EXPECT_NEAR(hit->range_mm, 20.0 - half_chord_mm, 1e-7) << angle << " " << inside_mm;
    }
  }
  EXPECT_GT(met, 10000);
}

// A box with edges rounded by 2 mm, all of it shifted or turned: it is the same box in another place, at its
// rounded edges and at their seams, too. The closed form of the deviation from the nominal box holds where
// the moved point is still above the same plane or edge.
TEST(VirtualPart, APartThatMovesAsAWholeKeepsItsShape) {
  const Vec3 middle_mm(8.0, 18.0, 15.0);  // of the rounding of an edge along z
  const auto on_box_mm = [](const Vec3& outward) {
    if (outward.y() < 0.0) return 2.0 / outward.x();
    if (outward.x() < 0.0) return 2.0 / outward.y();
    return 2.0;
  };
  struct Motion {
    Vec3 shift_mm;
    double angle_rad;  // about the middle of the rounding
  };
  for (const Motion& motion : {Motion{{0, 0.3, 0}, 0.0}, Motion{{0.3, -0.2, 0}, 0.0},
                               Motion{{-0.3, 0, 0}, 0.0}, Motion{{0, 0, 0}, 0.1}}) {
    PlatformShift everything;
    everything.top_mm = 1000.0;
    everything.shift_mm = motion.shift_mm;
    AirfoilTwist turn_of_all;
    turn_of_all.axis = {middle_mm, Vec3::UnitZ(), -2000.0, -1000.0};  // all of the box is above the tip
    turn_of_all.tip_angle_rad = motion.angle_rad;
    const VirtualPart part = exact_part(TestShape::filleted_box, {everything, turn_of_all});
    for (int turn = -30; turn <= 120; ++turn) {
      const double angle = std::numbers::pi / 180.0 * (turn + 0.37);
      const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
      const Eigen::AngleAxisd moved(motion.angle_rad, Vec3::UnitZ());
      const Ray ray{middle_mm + motion.shift_mm + moved * (20.0 * outward), moved * -outward};
      const auto hit = first_hit(part, ray, kInfinity);
      ASSERT_TRUE(hit.has_value());
      EXPECT_TRUE(hit->refined) << turn;
      EXPECT_NEAR(hit->range_mm, 20.0 - on_box_mm(outward), 1e-8)
          << turn << " " << motion.shift_mm.transpose();

      const Vec3 from_middle = ray.origin_mm + hit->range_mm * ray.direction - middle_mm;
      double expected_mm = std::hypot(from_middle.x(), from_middle.y()) - 2.0;
      if (from_middle.y() < 0.0) expected_mm = from_middle.x() - 2.0;
      if (from_middle.x() < 0.0) expected_mm = from_middle.y() - 2.0;
      EXPECT_NEAR(true_deviation_mm(part, ray, *hit), expected_mm, 1e-8) << turn;
    }
  }
}

}  // namespace
}  // namespace trueblade
