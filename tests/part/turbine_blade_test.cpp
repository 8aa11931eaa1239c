// The demonstration blade: its surfaces, closedness, size, sections and smoothness against its parameters.
#include "part/turbine_blade.h"

#include <numbers>

#include "part/chord_error.h"
#include "tests/part/demonstration_checks.h"

namespace trueblade {
namespace {

namespace fs = std::filesystem;

constexpr double kChordTolerance_mm = 0.02;

class TurbineBlade : public testing::Test {
 protected:
  static const Part& blade() {
    static const Part part = make_turbine_blade(parameters_, {kChordTolerance_mm, 0.2});
    return part;
  }
  static inline const TurbineBladeParameters parameters_{};
};

bool starts_with(const std::string& text, const char* beginning) {
  return text.rfind(beginning, 0) == 0;
}

bool is_airfoil_or_fillet(const std::string& name) {
  return name != "tip" && !starts_with(name, "root_") && !starts_with(name, "platform_");
}

TEST_F(TurbineBlade, Has102Surfaces) {
  EXPECT_EQ(blade().surfaces.size(), 102u);
  EXPECT_EQ(surface_count(parameters_), 102);
  expect_named_surfaces_with_facets(blade());
}

TEST_F(TurbineBlade, IsClosed) {
  expect_closed_manifold(blade());
}

TEST_F(TurbineBlade, FacetsStayWithinTheChordTolerance) {
  const auto errors = chord_errors_mm(blade());
  ASSERT_TRUE(errors);
  // Within surfaces the tolerance holds; along their borders the kernel exceeds it by a factor of up to two.
  EXPECT_LE(*std::max_element(errors->begin(), errors->end()), 2.0 * kChordTolerance_mm);
}

TEST_F(TurbineBlade, BoundingBoxIsPlatformTipAndRoot) {
  const Vec3 low = blade().model.lower_corner_mm(), high = blade().model.upper_corner_mm();
  // The corners are vertices of the solid; 1e-9 is rounding at 100 mm with a factor of 1e4.
  EXPECT_LT((low - Vec3(-23.0, -13.0, -32.0)).norm(), 1e-9);
  EXPECT_LT((high - Vec3(23.0, 13.0, 68.0)).norm(), 1e-9);
}

TEST_F(TurbineBlade, VolumeLiesBetweenClosedFormBounds) {
  const double platform = 46.0 * 26.0 * 5.0;
  // The root lies between the prisms within its valleys and within its crests.
  const double valley_bottom = 16.0 - 2.0 * 22.0 * std::tan(14.0 * std::numbers::pi / 180.0);
  const double valleys = 40.0 * (16.0 * 5.0 + 0.5 * (16.0 + valley_bottom) * 22.0);
  const double crests = valleys + 40.0 * 2.0 * 1.9 * 22.0;
  // Sections fill between 0.5 (a double wedge) and 0.8 (an ellipse) of chord times thickness; Simpson's rule
  // is exact for the product of two linear functions. The fillet adds less than a prism of r^2 / 4 round a
  // circumference of three chords.
  const double box = 68.0 / 6.0 * (36.0 * 3.6 + 4.0 * 32.5 * 2.8 + 29.0 * 2.0);
  const double fillet = 3.0 * 3.0 / 4.0 * 3.0 * 36.0;
  EXPECT_GT(blade().model.volume_mm3(), platform + valleys + 0.5 * box);
  EXPECT_LT(blade().model.volume_mm3(), platform + crests + 0.8 * box + fillet);
}

TEST_F(TurbineBlade, AirfoilAndFilletHaveNoKinks) {
  // Largest along the fillet's upper border beside a joint of strips: there the row of poles below the border
  // is turned by the airfoil's twist, 0.011 rad, over one knot interval of 0.3 mm; a cubic is then off by
  // 4/27 of 0.011 times 0.3 mm, 5e-4 mm, over the 1.66 mm between the rows.
  EXPECT_LT(largest_kink_rad(blade(), is_airfoil_or_fillet), 5e-4);
}

TEST_F(TurbineBlade, FilletLeavesThePlatformWithinItsPlane) {
  const Part& part = blade();
  std::size_t nodes = 0;
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    const std::uint32_t surface = part.model.surface_of(facet);
    if (!starts_with(part.surfaces[surface].name, "fillet_")) continue;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(part.model.corners_mm(facet)[k].z()) < 1e-9) {
        const Vec3 normal = part.exact->evaluate(surface, part.facet_parameters[facet][k]).normal;
        EXPECT_LT((normal - Vec3::UnitZ()).norm(), 1e-9);  // both rows of poles lie in the plane
        ++nodes;
      }
  }
  EXPECT_GT(nodes, 50u);
}

struct Segment {
  Vec2 a, b;
  Vec2 inward;  // unit
};

// The facets' cut with the plane at `z_mm`.
std::vector<Segment> section_at(const Part& part, double z_mm) {
  std::vector<Segment> segments;
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    const auto corners = part.model.corners_mm(facet);
    std::vector<Vec2> cut;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &p = corners[k], &q = corners[(k + 1) % 3];
      if ((p.z() < z_mm) == (q.z() < z_mm)) continue;
      cut.push_back((p + (q - p) * (z_mm - p.z()) / (q.z() - p.z())).head<2>());
    }
    if (cut.size() == 2)
      segments.push_back({cut[0], cut[1], -part.model.facet_normal(facet).head<2>().normalized()});
  }
  return segments;
}

TEST_F(TurbineBlade, MidSpanSectionHasTheStatedChordAndStagger) {
  const auto section = section_at(blade(), 34.0 + 1e-7);  // beside the nodes at mid-span
  const double stagger = 0.5 * (14.0 + 40.0) * std::numbers::pi / 180.0;
  const Vec2 along(std::cos(stagger), std::sin(stagger)), across(-along.y(), along.x());
  double low = 1e9, high = -1e9, height_low = 0.0, height_high = 0.0;
  for (const Segment& segment : section)
    for (const Vec2& point : {segment.a, segment.b}) {
      if (point.dot(along) < low) low = point.dot(along), height_low = point.dot(across);
      if (point.dot(along) > high) high = point.dot(along), height_high = point.dot(across);
    }
  EXPECT_NEAR(high - low, 0.5 * (36.0 + 29.0), 2.0 * kChordTolerance_mm);  // facets, at both ends
  // The extreme points lie on arcs of radius 0.35 and 0.275 whose centres the chord line joins. With facets
  // that turn by 0.2 rad they are found within 0.1 rad of the chord line.
  EXPECT_NEAR(height_high - height_low, 0.0, 0.1 * (0.35 + 0.275) + 2.0 * kChordTolerance_mm);
}

TEST_F(TurbineBlade, MidSpanSectionHasTheStatedThickness) {
  const auto section = section_at(blade(), 34.0 + 1e-7);
  // The circle that touches the outline at p from inside and passes through q has the radius
  // |q - p|^2 / (2 n (q - p)); the inscribed one is the least over all q.
  double largest = 0.0;
  for (const Segment& segment : section) {
    const Vec2 point = 0.5 * (segment.a + segment.b);
    double radius = 1e9;
    for (const Segment& other : section)
      for (const Vec2& q : {other.a, other.b, Vec2(0.5 * (other.a + other.b))})
        if (const double depth = 2.0 * segment.inward.dot(q - point); depth > 0.1)
          radius = std::min(radius, (q - point).squaredNorm() / depth);
    largest = std::max(largest, radius);
  }
  EXPECT_NEAR(2.0 * largest, 0.5 * (3.6 + 2.0), 2.0 * kChordTolerance_mm);
}

TEST_F(TurbineBlade, SuctionSideLooksToPositiveY) {
  const Part& part = blade();
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    const std::string& name = part.surfaces[part.model.surface_of(facet)].name;
    const double sign = starts_with(name, "suction_") ? 1.0 : starts_with(name, "pressure_") ? -1.0 : 0.0;
    EXPECT_GE(sign * part.model.facet_normal(facet).y(), 0.0) << name;
  }
}

TEST_F(TurbineBlade, ComesBackFromStep) {
  const TemporaryFolder folder;
  write_turbine_blade(parameters_, folder / "blade.step");
  const Part read = read_part(folder / "blade.step", {std::nullopt, {kChordTolerance_mm, 0.2}});
  ASSERT_EQ(read.surfaces.size(), 102u);
  expect_closed_manifold(read);
  std::set<std::string> written, found;
  for (const PartSurface& surface : blade().surfaces) written.insert(surface.name);
  for (const PartSurface& surface : read.surfaces) found.insert(surface.name);
  EXPECT_EQ(written, found);
}

TEST_F(TurbineBlade, CountsItsSurfacesForOtherParameters) {
  TurbineBladeParameters p;
  p.root_teeth = 2;
  p.spanwise_patches = 2;
  p.chordwise_patches = 1;
  const Part part = make_turbine_blade(p, {0.2, 0.5});
  EXPECT_EQ(part.surfaces.size(), static_cast<std::size_t>(surface_count(p)));
  expect_closed_manifold(part);
}

TEST_F(TurbineBlade, IsBuiltThroughEveryRealSection) {
  const fs::path folder = fs::path(TRUEBLADE_DATA_DIR) / "airfoils";
  if (!fs::exists(folder)) GTEST_SKIP() << "no real sections in " << folder;
  for (const auto& entry : fs::directory_iterator(folder)) {
    TurbineBladeParameters p;
    p.section_file = entry.path().string();
    // A wing's section: at this thickness its nose has a radius of 0.54 mm at the root, 0.3 mm at the tip.
    if (entry.path().stem() == "c141a") {
      p.root_leading_edge_radius_mm = 0.7;
      p.tip_leading_edge_radius_mm = 0.4;
    }
    const Part part = make_turbine_blade(p, {0.1, 0.5});
    EXPECT_EQ(part.surfaces.size(), 102u) << entry.path();
    EXPECT_TRUE(part.report.closed) << entry.path();
    EXPECT_GT(part.model.volume_mm3(), 0.0) << entry.path();
  }
}

TEST_F(TurbineBlade, RefusesParametersThatMakeNoBlade) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto refused = [&](const char* field, double TurbineBladeParameters::*member,
                           std::initializer_list<double> values) {
    for (const double value : values) {
      TurbineBladeParameters p;
      p.*member = value;
      expect_refused(field, [&] { p.validate(); });
    }
  };
  using P = TurbineBladeParameters;
  refused("span_mm", &P::span_mm, {-1.0, 0.0, nan, infinity});
  refused("root_chord_mm", &P::root_chord_mm, {-36.0, 0.0, nan, infinity});
  refused("tip_chord_mm", &P::tip_chord_mm, {-1.0, nan});
  refused("root_max_thickness_mm", &P::root_max_thickness_mm, {-1.0, 0.0, 36.0, nan});
  refused("tip_max_thickness_mm", &P::tip_max_thickness_mm, {-1.0, 9.0, nan});
  refused("root_leading_edge_radius_mm", &P::root_leading_edge_radius_mm, {-0.1, 0.0, 1.8, nan});
  refused("tip_trailing_edge_radius_mm", &P::tip_trailing_edge_radius_mm, {-0.1, 1.0, nan});
  refused("section_lift_coefficient", &P::section_lift_coefficient, {-0.1, 2.1, nan});
  refused("root_camber_factor", &P::root_camber_factor, {-1.0, nan});
  refused("root_stagger_deg", &P::root_stagger_deg, {-81.0, 90.0, nan});
  refused("tip_stagger_deg", &P::tip_stagger_deg, {-79.0, nan});
  refused("fillet_radius_mm", &P::fillet_radius_mm, {0.0, -1.0, 20.0, nan});
  refused("platform_length_mm", &P::platform_length_mm, {0.0, nan});
  refused("platform_width_mm", &P::platform_width_mm, {-1.0, nan});
  refused("platform_thickness_mm", &P::platform_thickness_mm, {0.0, nan});
  refused("root_length_mm", &P::root_length_mm, {0.0, 46.0, nan});
  refused("root_height_mm", &P::root_height_mm, {0.0, nan});
  refused("root_neck_height_mm", &P::root_neck_height_mm, {0.0, 27.0, nan});
  refused("root_neck_width_mm", &P::root_neck_width_mm, {0.0, 25.0, nan});
  refused("root_taper_deg", &P::root_taper_deg, {-1.0, 46.0, nan});
  refused("root_tooth_depth_mm", &P::root_tooth_depth_mm, {0.0, 17.0, nan});
  refused("root_corner_radius_mm", &P::root_corner_radius_mm, {0.0, nan});
  for (const int count : {0, -1, 1000000}) {
    P p;
    p.root_teeth = count;
    expect_refused("root_teeth", [&] { p.validate(); });
    p = {};
    p.spanwise_patches = count;
    expect_refused("spanwise_patches", [&] { p.validate(); });
    p = {};
    p.chordwise_patches = count;
    expect_refused("chordwise_patches", [&] { p.validate(); });
  }
}

// Each number is possible; only building shows that they do not fit each other.
TEST_F(TurbineBlade, RefusesParametersThatDoNotFitEachOther) {
  const auto refused = [&](const char* field, const auto& change) {
    TurbineBladeParameters p;
    change(p);
    expect_refused(field, [&] { make_turbine_blade(p, {0.2, 0.5}); });
  };
  using P = TurbineBladeParameters;
  // The fillet leaves the platform.
  refused("platform_length_mm", [](P& p) { p.platform_length_mm = 40.5; });
  refused("platform_width_mm", [](P& p) { p.fillet_radius_mm = 8.0, p.platform_length_mm = 80.0; });
  // The corners are longer than the flanks; the valleys meet above the bottom.
  refused("root_corner_radius_mm", [](P& p) { p.root_corner_radius_mm = 1.9; });
  refused("root_taper_deg", [](P& p) { p.root_taper_deg = 30.0; });
  // Sharper than the section's own nose.
  refused("root_leading_edge_radius_mm", [](P& p) { p.root_leading_edge_radius_mm = 0.1; });
}

TEST_F(TurbineBlade, RefusesBadFiles) {
  TurbineBladeParameters p;
  p.section_file = "/no/such/section.dat";
  EXPECT_THROW(make_turbine_blade(p, {0.2, 0.5}), InputError);
  EXPECT_THROW(write_turbine_blade(parameters_, "/no/such/folder/blade.step"), InputError);
  EXPECT_THROW(make_turbine_blade(parameters_, {-0.1, 0.5}), InputError);
}

}  // namespace
}  // namespace trueblade
