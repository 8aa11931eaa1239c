// The demonstration sheet part: its surfaces, closedness, wall thickness and volume against its parameters.
#include "part/formed_part.h"

#include <limits>

#include "geometry/closest_point_tree.h"
#include "part/chord_error.h"
#include "part/forming.h"
#include "tests/part/demonstration_checks.h"

namespace trueblade {
namespace {

constexpr double kChordTolerance_mm = 0.02;

class FormedPart : public testing::Test {
 protected:
  static const Part& sheet() {
    static const Part part = make_formed_part(parameters_, {kChordTolerance_mm, 0.3});
    return part;
  }
  static inline const FormedPartParameters parameters_{};
};

bool starts_with(const std::string& text, const char* beginning) {
  return text.rfind(beginning, 0) == 0;
}

double area_of(const Part& part, const char* name) {
  double area = 0.0;
  for (const PartSurface& surface : part.surfaces)
    if (starts_with(surface.name, name)) area += surface.area_mm2;
  return area;
}

std::vector<std::uint32_t> facets_of(const Part& part, const char* name) {
  std::vector<std::uint32_t> facets;
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet)
    if (starts_with(part.surfaces[part.model.surface_of(facet)].name, name)) facets.push_back(facet);
  return facets;
}

TEST_F(FormedPart, Has165Surfaces) {
  EXPECT_EQ(sheet().surfaces.size(), 165u);
  EXPECT_EQ(surface_count(parameters_), 165);
  expect_named_surfaces_with_facets(sheet());
}

TEST_F(FormedPart, IsClosed) {
  expect_closed_manifold(sheet());
}

TEST_F(FormedPart, HasThreeHoles) {
  // Euler: nodes - edges + facets = 2 - 2 * holes for a closed surface; edges = 3/2 facets.
  const auto nodes = static_cast<long>(sheet().model.node_count()),
             facets = static_cast<long>(sheet().model.facet_count());
  EXPECT_EQ(nodes - facets / 2, 2 - 2 * 3);
}

TEST_F(FormedPart, FacetsStayWithinTheChordTolerance) {
  const auto errors = chord_errors_mm(sheet());
  ASSERT_TRUE(errors);
  // Within surfaces the tolerance holds; along their borders the kernel exceeds it by a factor of up to two.
  EXPECT_LE(*std::max_element(errors->begin(), errors->end()), 2.0 * kChordTolerance_mm);
}

TEST_F(FormedPart, HasNoDatumPlane) {
  for (const PartSurface& surface : sheet().surfaces) EXPECT_NE(surface.kind, "plane") << surface.name;
}

TEST_F(FormedPart, HasItsSize) {
  const Vec3 size = sheet().model.upper_corner_mm() - sheet().model.lower_corner_mm();
  EXPECT_NEAR(size.x(), 120.0, 0.02);  // the ends bulge over their middle by the chord tolerance at most
  // About 120 x 80 x 30.
  EXPECT_NEAR(size.y(), 80.0, 5.0);
  EXPECT_NEAR(size.z(), 30.0, 5.0);
}

TEST_F(FormedPart, SkinsHaveNoKinks) {
  // One bicubic spline each, cut into patches: rounding, 1e-12 of 100 mm over knots 2 mm apart.
  for (const char* skin : {"outer_", "inner_"})
    EXPECT_LT(largest_kink_rad(sheet(), [&](const std::string& name) { return starts_with(name, skin); }),
              1e-9);
}

TEST_F(FormedPart, OuterSkinIsTheFormedSurface) {
  const Forming forming(parameters_);
  const ClosestPointTree outer(sheet().model, facets_of(sheet(), "outer_"));
  for (const double across : {-40.0, -30.0, -16.0, -3.0, 8.0, 20.0, 33.0})
    for (const double along : {-0.85, -0.52, 0.11, 0.43, 0.9}) {
      // Facets, and the spline through points h = 2 mm apart: ramps of 2.4 mm height and w = 5.9 mm width
      // have fourth derivatives up to 360 h / w^4 = 0.7 / mm^3, and 0.7 * 2^4 / 384 = 0.03 mm; the darts'
      // are 4.5 mm wide and 2 mm deep: 0.07 mm.
      EXPECT_LT(outer.query(forming.point(across, along)).distance_mm, kChordTolerance_mm + 0.07)
          << across << ' ' << along;
    }
}

TEST_F(FormedPart, WallHasTheStatedThickness) {
  const ClosestPointTree inner(sheet().model, facets_of(sheet(), "inner_"));
  const Forming forming(parameters_);
  std::vector<Vec3> holes;
  for (const Vec2& centre : forming.hole_centres()) holes.push_back(forming.point(centre.x(), centre.y()));
  const Vec3 low = sheet().model.lower_corner_mm(), high = sheet().model.upper_corner_mm();
  const double tolerance = 2.0 * kChordTolerance_mm + 2.0 * 0.07;  // facets and splines of both skins
  double thinnest = 1e9, thickest = 0.0;
  for (const std::uint32_t facet : facets_of(sheet(), "outer_")) {
    const auto corners = sheet().model.corners_mm(facet);
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const double distance = inner.query(middle).distance_mm;
    thinnest = std::min(thinnest, distance);
    // Beside rims and holes the foot on the inner skin may be cut away.
    const bool beside_hole = std::any_of(holes.begin(), holes.end(), [&](const Vec3& hole) {
      return (middle - hole).norm() < parameters_.hole_diameter_mm;
    });
    const bool beside_rim =
        middle.x() < low.x() + 12.0 || middle.x() > high.x() - 12.0 || middle.z() < low.z() + 12.0;
    if (!beside_hole && !beside_rim) thickest = std::max(thickest, distance);
  }
  EXPECT_NEAR(thinnest, parameters_.thickness_mm, tolerance);
  EXPECT_NEAR(thickest, parameters_.thickness_mm, tolerance);
}

TEST_F(FormedPart, VolumeIsThicknessTimesMeanArea) {
  // Steiner: a wall of thickness t between parallel surfaces has the volume t (A_outer + A_inner) / 2 less
  // t^3 / 6 times the integral of the Gaussian curvature, which for a disc-like sheet is at most its whole
  // turn, 4 pi.
  const double t = parameters_.thickness_mm;
  const double expected = 0.5 * t * (area_of(sheet(), "outer_") + area_of(sheet(), "inner_"));
  const double area = 0.5 * (area_of(sheet(), "outer_") + area_of(sheet(), "inner_"));
  const double gauss = t * t * t / 6.0 * 4.0 * 3.1416;
  // Facets may lie off both skins by the chord tolerance, and so does, on average far less, the wall.
  EXPECT_NEAR(sheet().model.volume_mm3(), expected, gauss + kChordTolerance_mm * area);
}

TEST_F(FormedPart, RefusesParametersThatMakeNoPart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const char* field, double FormedPartParameters::*member,
                           std::initializer_list<double> values) {
    for (const double value : values) {
      FormedPartParameters p;
      p.*member = value;
      expect_refused(field, [&] { p.validate(); });
    }
  };
  using P = FormedPartParameters;
  refused("length_mm", &P::length_mm, {-1.0, 0.0, 1e9, nan});
  refused("thickness_mm", &P::thickness_mm, {-1.0, 0.0, 6.0, nan});
  refused("front_flange_mm", &P::front_flange_mm, {-1.0, nan});
  refused("panel_mm", &P::panel_mm, {-1.0, nan});
  refused("back_flange_mm", &P::back_flange_mm, {0.0, nan});
  refused("front_bend_deg", &P::front_bend_deg, {0.0, 85.0, nan});
  refused("back_bend_deg", &P::back_bend_deg, {10.0, 90.0, nan});
  refused("bend_twist_deg", &P::bend_twist_deg, {-1.0, 31.0, nan});
  refused("bend_radius_mm", &P::bend_radius_mm, {0.0, 2.0, nan});
  refused("lengthwise_crown_mm", &P::lengthwise_crown_mm, {-1.0, 50.0, nan});
  refused("crosswise_crown_deg", &P::crosswise_crown_deg, {-1.0, 90.0, nan});
  refused("bead_height_mm", &P::bead_height_mm, {-1.0, 5.0, nan});
  refused("dart_depth_mm", &P::dart_depth_mm, {-1.0, 5.0, nan});
  refused("corner_radius_mm", &P::corner_radius_mm, {0.0, 11.0, nan});
  refused("hole_diameter_mm", &P::hole_diameter_mm, {0.0, 20.0, nan});
  for (const int count : {0, -3, 1000000}) {
    P p;
    p.lengthwise_patches = count;
    expect_refused("lengthwise_patches", [&] { p.validate(); });
  }
}

}  // namespace
}  // namespace trueblade
