// Covers: chord, thickness, edge radii, stagger, twist and displacement of an elliptic cylinder that was
// scaled, turned and shifted, against closed forms; bow; sections outside the part and without points; an
// edge that was not measured, or from one side only, or too noisy; limits of the specification; the rigid fit
// of a section; ends of the maximum chord between points and at corners; outlines of exact surfaces; the same
// features of a known section, also across an oblique plane.
#include "inspection/measure_section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/random.h"
#include "inspection/known_section.h"
#include "inspection/section_features.h"
#include "inspection/section_rigid_fit.h"
#include "part/part.h"
#include "tests/inspection/fixtures.h"
#include "tests/part/cad_files.h"

namespace trueblade {
namespace {

constexpr double kHalfChord = 15.0, kHalfThickness = 2.0;

Vec3 on_ellipse(double t, double z) {
  return {kHalfChord * std::cos(t), kHalfThickness * std::sin(t), z};
}

// |z| <= 5, 800 facets around: at the edges 16 um apart on a radius of 0.27 mm, sagitta 0.12 um.
const Part& elliptic_cylinder() {
  static const Part part = [] {
    constexpr std::uint32_t n = 800;
    FacetSoup soup;
    for (const double z : {-5.0, 5.0})
      for (std::uint32_t i = 0; i < n; ++i)
        soup.nodes_mm.push_back(on_ellipse(2.0 * std::numbers::pi * i / n, z));
    soup.nodes_mm.push_back({0, 0, -5});
    soup.nodes_mm.push_back({0, 0, 5});
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      soup.facets.push_back({i, j, n + j});
      soup.facets.push_back({i, n + j, n + i});
      soup.facets.push_back({2 * n, j, i});
      soup.facets.push_back({2 * n + 1, n + i, n + j});
    }
    Part made;
    FacetModelBuild build = build_facet_model(soup, 0.0);
    made.model = std::move(build.model);
    made.surfaces = {{"all", "facets", made.model.facet_count(), made.model.area_mm2()}};
    return made;
  }();
  return part;
}

using Deformation = std::function<Vec3(const Vec3&)>;

// Rows of points 0.3 mm apart, 700 around in each; `keep` chooses by the angle of the ellipse.
Deviations measured(
    const Deformation& deformed, double noise_mm = 0.0,
    const std::function<bool(double)>& keep = [](double) { return true; }) {
  ScanPoints scan;
  Rng random(7, 0, "section test");
  for (int row = -3; row <= 3; ++row)
    for (int i = 0; i < 700; ++i) {
      const double t = 2.0 * std::numbers::pi * (i + 0.1 * row) / 700.0;
      if (!keep(t)) continue;
      const Vec3 p = on_ellipse(t, 0.3 * row);
      const Vec3 normal =
          Vec3(p.x() / (kHalfChord * kHalfChord), p.y() / (kHalfThickness * kHalfThickness), 0).normalized();
      scan.position_mcs_mm.push_back(deformed(p) + noise_mm * random.normal() * normal);
    }
  Deviations d = deviations_of(elliptic_cylinder(), scan, {});
  d.outliers = {std::vector<bool>(d.size(), false), 0, 0.0, 0.0};  // the known deformation is no outlier
  return d;
}

double value(const SectionResult& section, const char* name) {
  const SectionFeature* feature = section.find(name);
  EXPECT_NE(feature, nullptr) << name;
  EXPECT_EQ(feature->reason, "") << name;
  return feature->measured;
}

TEST(MeasureSection, NominalFeaturesAreTheEllipses) {
  const SectionResult section =
      measure_section(elliptic_cylinder(), {}, 0.0, measured([](const Vec3& p) { return p; }));
  ASSERT_EQ(section.missing, "");
  EXPECT_NEAR(section.find("chord")->nominal, 30.0, 1e-4);
  EXPECT_NEAR(section.find("maximum_thickness")->nominal, 4.0, 1e-4);
  EXPECT_NEAR(section.find("stagger")->nominal, 0.0, 1e-5);
  for (const SectionFeature& feature : section.features) {
    EXPECT_NEAR(feature.deviation(), 0.0, 2e-4) << feature.name;
    EXPECT_NE(feature.method, "") << feature.name;
  }
  EXPECT_GT(section.covered_percent, 99.0);
}

TEST(MeasureSection, AScaledSectionScalesItsLengths) {
  constexpr double scale = 1.002;  // chord + 60 um, thickness + 8 um
  const SectionResult section =
      measure_section(elliptic_cylinder(), {}, 0.0,
                      measured([](const Vec3& p) { return Vec3(scale * p.x(), scale * p.y(), p.z()); }));
  // Second order in the deviation's slope along the outline: (30 um / 1 mm)^2 of 1 mm is 1 um at the edges.
  EXPECT_NEAR(value(section, "chord"), 30.0 * scale, 1e-3);
  EXPECT_NEAR(value(section, "maximum_thickness"), 4.0 * scale, 1e-3);
  const SectionFeature& radius = *section.find("leading_edge_radius");
  // The edge of an ellipse is no circle, and the feet whose normals lie within 50 degrees meet another piece
  // of the larger ellipse: circles through q = p + d n on it and through the feet p, computed apart, are
  // as 1.0229.
  EXPECT_NEAR(radius.measured / radius.nominal, 1.0229, 1e-3);
  // The rows of points are shifted by a tenth of their spacing: not quite symmetric.
  EXPECT_NEAR(value(section, "twist"), 0.0, 3e-6);
  EXPECT_NEAR(value(section, "displacement_x"), 0.0, 1e-4);
}

TEST(MeasureSection, ATurnedAndShiftedSectionIsToldFromItsShape) {
  constexpr double twist = 1e-3;
  const Vec3 shift(0.02, -0.03, 0.0);
  const SectionResult section = measure_section(
      elliptic_cylinder(), {}, 0.0,
      measured([&](const Vec3& p) { return Vec3(rotation_from_vector(Vec3(0, 0, twist)) * p + shift); }));
  // The deviations are linear in twist and shift up to their square over the edge radius, 15 um^2 / 0.27 mm;
  // the edges are a fiftieth of the outline.
  EXPECT_NEAR(value(section, "twist"), twist, 1e-5);
  EXPECT_NEAR(value(section, "displacement_x"), shift.x(), 1e-3);
  EXPECT_NEAR(value(section, "displacement_y"), shift.y(), 1e-3);
  EXPECT_NEAR(value(section, "stagger"), twist, 1e-4);
  EXPECT_NEAR(value(section, "chord"), 30.0, 1e-3);
  EXPECT_NEAR(value(section, "maximum_thickness"), 4.0, 1e-3);
}

TEST(MeasureSection, NoiseStaysWithinTheStatedUncertainty) {
  const SectionResult section =
      measure_section(elliptic_cylinder(), {}, 0.0, measured([](const Vec3& p) { return p; }, 0.003));
  for (const SectionFeature& feature : section.features) {
    EXPECT_GT(feature.uncertainty, 0.0) << feature.name;
    EXPECT_LT(std::abs(feature.deviation()), 4.0 * feature.uncertainty) << feature.name;
    EXPECT_LT(feature.uncertainty, 0.003) << feature.name;  // the noise of one point
  }
}

TEST(MeasureSection, AnEdgeThatWasNotMeasuredHasNoChord) {
  const SectionResult section = measure_section(
      elliptic_cylinder(), {}, 0.0,
      measured([](const Vec3& p) { return p; }, 0.0, [](double t) { return std::cos(t) < 0.95; }));
  for (const char* name : {"chord", "stagger", "trailing_edge_radius"}) {
    const SectionFeature& feature = *section.find(name);
    EXPECT_NE(feature.reason, "") << name;
    EXPECT_TRUE(std::isnan(feature.measured)) << name;
  }
  EXPECT_NEAR(value(section, "maximum_thickness"), 4.0, 1e-4);
  EXPECT_NEAR(value(section, "twist"), 0.0, 1e-5);
}

// The edges, of 0.27 mm radius, are shifted by a third of it across the chord: every foot point lies
// elsewhere on the edge, and the chord is what it was.
TEST(MeasureSection, ASidewaysShiftLeavesTheChordAlone) {
  const SectionResult section = measure_section(
      elliptic_cylinder(), {}, 0.0, measured([](const Vec3& p) { return Vec3(p + Vec3(0, 0.09, 0)); }));
  EXPECT_NEAR(value(section, "chord"), 30.0, 1e-3);
  EXPECT_NEAR(value(section, "stagger"), 0.0, 2e-5);
  EXPECT_NEAR(value(section, "maximum_thickness"), 4.0, 1e-3);
  EXPECT_NEAR(value(section, "displacement_y"), 0.09, 1e-3);
}

TEST(MeasureSection, AnEdgeSeenFromOneSideHasNoRadius) {
  const SectionResult section =
      measure_section(elliptic_cylinder(), {}, 0.0,
                      measured([](const Vec3& p) { return p; }, 0.0,
                               [](double t) { return std::cos(t) > -0.9 || std::sin(t) > 0.0; }));
  const SectionFeature& radius = *section.find("leading_edge_radius");
  EXPECT_TRUE(std::isnan(radius.measured));
  EXPECT_NE(radius.reason.find("degrees to one side"), std::string::npos) << radius.reason;
  EXPECT_EQ(section.find("trailing_edge_radius")->reason, "");
}

// Ten points on the edge, as of 0.1 mm: 30 um of noise on a radius of 0.27 mm.
TEST(MeasureSection, ARadiusThatIsHardlyKnownIsNone) {
  Deviations few = measured([](const Vec3& p) { return p; }, 0.03);
  int on_edge = 0;
  for (std::size_t i = 0; i < few.size(); ++i)
    if (few.nominal_mm[i].x() < -14.8 && ++on_edge % 12 != 0) few.outliers.is_outlier[i] = true;
  const SectionFeature radius =
      *measure_section(elliptic_cylinder(), {}, 0.0, few).find("leading_edge_radius");
  EXPECT_TRUE(std::isnan(radius.measured));
  EXPECT_NE(radius.reason.find("15 % are needed"), std::string::npos) << radius.reason;
}

// The ends lie anywhere between the points of the outline, at the edge 31 um apart: of a millirad that the
// points alone would leave the parabola through three of them leaves a two hundredth.
TEST(MaximumChord, TurnsWithTheOutlineAndKeepsItsLength) {
  for (int step = 0; step < 20; ++step) {
    const double angle = 0.3 + 1e-4 * step;
    std::vector<Vec2> points_mm;
    for (int i = 0; i < 400; ++i) {
      const Vec3 p = rotation_from_vector(Vec3(0, 0, angle)) *
                     on_ellipse(2.0 * std::numbers::pi * (i + 0.05 * step) / 400.0, 0.0);
      points_mm.push_back(p.head<2>());
    }
    const Chord chord = maximum_chord(outline_through(points_mm));
    EXPECT_NEAR(chord.length_mm, 2.0 * kHalfChord, 1e-5) << step;
    EXPECT_NEAR(chord.stagger_rad, angle, 5e-6) << step;
  }
}

TEST(MaximumChord, EndsAtSharpCorners) {
  std::vector<Vec2> points_mm;
  for (const auto& [from, to] : {std::pair{Vec2(0, 0), Vec2(4, 0)}, std::pair{Vec2(4, 0), Vec2(4, 3)},
                                 std::pair{Vec2(4, 3), Vec2(0, 3)}, std::pair{Vec2(0, 3), Vec2(0, 0)}})
    for (int i = 0; i < 20; ++i) points_mm.push_back(from + (to - from) * i / 20.0);
  EXPECT_NEAR(maximum_chord(outline_through(points_mm)).length_mm, 5.0, 1e-12);
}

// A box with edges rounded by 2 mm, faceted to 0.05 mm: the outline is on the surfaces, not on the facets.
TEST(CutOutline, IsOnTheSurfacesAndFineAtBends) {
  const TemporaryFolder folder;
  write_test_shape(TestShape::filleted_box, folder / "shape.step");
  PartOptions options;
  options.faceting.chord_tolerance_mm = 0.05;
  const Part part = read_part(folder / "shape.step", options);
  const SectionOutline outline =
      cut_outline(part, {Vec3(0, 0, 15), Vec3::UnitZ(), Vec3::UnitX()}, 0.5, 2.0 * std::numbers::pi / 180.0);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 from_middle = (outline.point_mm[i] - Vec2(5, 10)).cwiseAbs() - Vec2(3, 8);
    const double outside_mm = from_middle.cwiseMax(0.0).norm() - 2.0;
    EXPECT_NEAR(outside_mm, 0.0, 1e-9) << outline.point_mm[i].transpose();
    EXPECT_GT(outline.normal[i].dot(outline.normal[(i + 1) % outline.size()]),
              std::cos(3.0 * std::numbers::pi / 180.0));
  }
  EXPECT_NEAR(outline.length_mm, 2.0 * (6 + 16) + 4.0 * std::numbers::pi, 2e-3);
}

TEST(MeasureSection, SaysWhatIsMissing) {
  const Deviations nominal = measured([](const Vec3& p) { return p; });
  EXPECT_NE(measure_section(elliptic_cylinder(), {}, 20.0, nominal).missing.find("no closed outline"),
            std::string::npos);
  const SectionResult empty = measure_section(elliptic_cylinder(), {}, 4.0, nominal);
  EXPECT_NE(empty.missing.find("0 points within 1 mm"), std::string::npos) << empty.missing;
  SectionsSpec crooked;
  crooked.x_direction = Vec3::UnitZ();
  EXPECT_THROW(crooked.validate(), InputError);
}

TEST(MeasureSection, BowIsTheDistanceFromTheLineOfTheEnds) {
  std::vector<SectionResult> sections(3);
  const double height[] = {0.0, 10.0, 40.0}, x[] = {0.1, 0.2, 0.3}, y[] = {0.0, 0.0, 0.08};
  for (std::size_t k = 0; k < 3; ++k) {
    sections[k].height_mm = height[k];
    for (const auto& [name, v] : {std::pair{"displacement_x", x[k]}, std::pair{"displacement_y", y[k]}}) {
      SectionFeature feature;
      feature.name = name;
      feature.measured = v;
      feature.uncertainty = 0.001;
      sections[k].features.push_back(feature);
    }
  }
  add_bow(sections);
  EXPECT_EQ(sections[0].find("bow_x"), nullptr);
  EXPECT_NEAR(sections[1].find("bow_x")->measured, 0.2 - (0.1 + 0.25 * 0.2), 1e-12);
  EXPECT_NEAR(sections[1].find("bow_y")->measured, -0.02, 1e-12);
  EXPECT_NEAR(sections[1].find("bow_x")->uncertainty, 0.001 * std::sqrt(1.0 + 0.75 * 0.75 + 0.25 * 0.25),
              1e-12);
}

TEST(KnownSection, AScaledSectionScalesItsLengths) {
  const RegistrationTarget target(elliptic_cylinder());
  constexpr double scale = 1.002;
  const SectionResult section =
      KnownSection(target, {}, 0.0).features([](const Vec3& p, const Vec3&) -> Vec3 {
        return {(scale - 1.0) * p.x(), (scale - 1.0) * p.y(), 0.0};
      });
  for (const char* name : {"chord", "maximum_thickness", "leading_edge_radius", "trailing_edge_radius"})
    EXPECT_NEAR(value(section, name) / section.find(name)->nominal, scale, 1e-6) << name;
  EXPECT_NEAR(value(section, "chord"), 30.0 * scale, 1e-4);
  EXPECT_NEAR(value(section, "maximum_thickness"), 4.0 * scale, 1e-4);
  for (const char* name : {"stagger", "twist", "displacement_x", "displacement_y"})
    EXPECT_NEAR(section.find(name)->deviation(), 0.0, 1e-6) << name;
}

TEST(KnownSection, ATurnedAndShiftedSectionKeepsItsShape) {
  const RegistrationTarget target(elliptic_cylinder());
  constexpr double twist = 1e-3;
  const Vec3 shift(0.02, -0.03, 0.0);
  const SectionResult section =
      KnownSection(target, {}, 0.0).features([&](const Vec3& p, const Vec3&) -> Vec3 {
        return rotation_from_vector(Vec3(0, 0, twist)) * p + shift - p;
      });
  // The centroid, about which the twist turns, is within 1e-6 mm of the axis.
  EXPECT_NEAR(value(section, "twist"), twist, 1e-8);
  EXPECT_NEAR(value(section, "displacement_x"), shift.x(), 1e-7);
  EXPECT_NEAR(value(section, "displacement_y"), shift.y(), 1e-7);
  EXPECT_NEAR(section.find("stagger")->deviation(), twist, 1e-8);
  EXPECT_NEAR(section.find("chord")->deviation(), 0.0, 1e-8);
  EXPECT_NEAR(section.find("maximum_thickness")->deviation(), 0.0, 1e-6);
}

// A layer of 0.05 mm on a cylinder that is cut at 45 degrees across its thickness is 0.05 sqrt(2) mm thick.
TEST(KnownSection, ALayerCutObliquely) {
  const RegistrationTarget target(elliptic_cylinder());
  SectionsSpec oblique;
  oblique.normal = Vec3(0, 1, 1).normalized();
  const SectionResult section =
      KnownSection(target, oblique, 0.0).features([](const Vec3&, const Vec3& normal) -> Vec3 {
        return 0.05 * normal;
      });
  EXPECT_NEAR(section.find("maximum_thickness")->nominal, 4.0 * std::numbers::sqrt2, 1e-4);
  EXPECT_NEAR(section.find("maximum_thickness")->deviation(), 0.1 * std::numbers::sqrt2, 1e-4);
  EXPECT_NEAR(section.find("chord")->deviation(), 0.1, 1e-4);
}

SectionOutline ellipse(double half_length_mm, double half_width_mm, int points) {
  std::vector<Vec2> points_mm;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    points_mm.emplace_back(half_length_mm * std::cos(angle), half_width_mm * std::sin(angle));
  }
  return outline_through(points_mm);
}

// An ellipse whose ends have a radius of 1.5^2 / 10 = 0.22 mm, moved by half of that: every point lies on the
// moved outline, so that the fit has no residual but at the true motion. The linear fit would be off by
// micrometres.
TEST(SectionRigidFit, FindsAMotionAsLargeAsTheEdgeIsRound) {
  const SectionOutline outline = ellipse(10.0, 1.5, 4000);
  const double twist_rad = 0.005;
  const Vec2 shift_mm(0.03, -0.1);
  std::vector<PlacedPoint> placed;
  for (std::size_t i = 0; i < outline.size(); i += 7) {
    const Vec2 arm_mm = outline.point_mm[i] - outline.centroid_mm;
    placed.push_back(
        {(i + 20) % outline.size(), outline.centroid_mm + shift_mm + Eigen::Rotation2Dd(twist_rad) * arm_mm});
  }
  const auto fit = fit_section_rigidly(outline, placed, std::vector<double>(placed.size(), 1.0));
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->twist_and_shift[0], twist_rad, 1e-9);
  EXPECT_NEAR(fit->twist_and_shift[1], shift_mm.x(), 1e-8);
  EXPECT_NEAR(fit->twist_and_shift[2], shift_mm.y(), 1e-8);
}

TEST(SectionRigidFit, ACircleTellsNoTwist) {
  const SectionOutline outline = ellipse(10.0, 10.0, 360);
  std::vector<PlacedPoint> placed;
  for (std::size_t i = 0; i < outline.size(); ++i) placed.push_back({i, outline.point_mm[i]});
  EXPECT_FALSE(fit_section_rigidly(outline, placed, std::vector<double>(placed.size(), 1.0)).has_value());
}

}  // namespace
}  // namespace trueblade
