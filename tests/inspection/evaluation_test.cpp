// Covers: the displacement of one group of surfaces against another, in closed form and within its stated
// uncertainty; a component that is not determined; the joint registration of two views and the difference
// between them; datum surfaces, of one view too; unknown surfaces, no views: the rest is made and what is
// missing is named; the selection of surfaces by id, range and name.
#include "inspection/evaluation.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/random.h"
#include "inspection/datum_fit.h"
#include "inspection/surface_selection.h"
#include "registration/register_scan.h"
#include "tests/inspection/fixtures.h"

namespace trueblade {
namespace {

constexpr double kHalf = 5.0;
const Vec3 kSecondCentre(30, 0, 0);

// Two cubes of 10 mm: surfaces 0 to 5 are the faces of the first, 6 to 11 those of the second.
Part two_cubes() {
  FacetSoup soup;
  for (const Vec3& centre : {Vec3(0, 0, 0), kSecondCentre}) {
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        const auto first = static_cast<std::uint32_t>(soup.nodes_mm.size());
        for (int k = 0; k < 4; ++k) {
          Vec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = k == 0 || k == 3 ? -1.0 : 1.0;
          p[(axis + 2) % 3] = k < 2 ? -side : side;
          soup.nodes_mm.push_back(centre + kHalf * p);
        }
        soup.facets.push_back({first, first + 1, first + 2});
        soup.facets.push_back({first, first + 2, first + 3});
        const auto surface = soup.surface_of_facet.empty() ? 0U : soup.surface_of_facet.back() + 1;
        soup.surface_of_facet.insert(soup.surface_of_facet.end(), 2, surface);
      }
  }
  Part part;
  FacetModelBuild build = build_facet_model(soup, 1e-9);
  part.model = std::move(build.model);
  for (int s = 0; s < 12; ++s)
    part.surfaces.push_back({(s < 6 ? "first_" : "second_") + std::to_string(s % 6), "facets", 2, 100.0});
  return part;
}

// Points 1 mm apart on the faces of one cube, moved by `moved`.
void add_faces(ScanPoints& scan, const Vec3& centre, const RigidTransform& moved, double noise_mm,
               const std::vector<int>& axes = {0, 1, 2}) {
  Rng random(3, 0, centre.x() > 0 ? "second" : "first");
  for (const int axis : axes)
    for (const double side : {-1.0, 1.0})
      for (int i = -4; i <= 4; ++i)
        for (int j = -4; j <= 4; ++j) {
          Vec3 p = Vec3::Zero();
          p[axis] = side * (kHalf + noise_mm * random.normal());
          p[(axis + 1) % 3] = i;
          p[(axis + 2) % 3] = j;
          scan.position_mcs_mm.push_back(moved * (centre + p));
        }
}

RigidTransform displaced(const Vec3& rotation_rad, const Vec3& shift_mm, const Vec3& about_mm) {
  Vec6 step;
  step << rotation_rad, shift_mm;
  return moved_about({}, step, about_mm);
}

EvaluationSpec groups() {
  EvaluationSpec spec;
  spec.groups = {{"first", {"first*"}}, {"second", {"6-11"}}};
  return spec;
}

EvaluationResult evaluate(const EvaluationSpec& spec, const Part& part, const ScanPoints& scan) {
  const RegistrationTarget target(part);
  const RegistrationOptions options = preset("default");
  const RegistrationResult registration = register_scan(target, scan, {}, options);
  const Deviations deviations = deviations_of(part, scan, registration.part_from_mcs);
  return evaluate_together(spec, target, options, DeviationSurface::facets,
                           {{"front", &scan, &registration, &deviations}});
}

TEST(Evaluation, AGroupIsFoundWhereItWasMoved) {
  const Part part = two_cubes();
  const Vec3 turn(1e-3, -2e-3, 5e-4), shift(0.02, -0.05, 0.01);
  ScanPoints scan;
  add_faces(scan, Vec3::Zero(), {}, 0.0);
  add_faces(scan, kSecondCentre, displaced(turn, shift, kSecondCentre), 0.0);
  const EvaluationResult result = evaluate(groups(), part, scan);
  ASSERT_TRUE(result.missing.empty()) << result.missing.front();
  ASSERT_EQ(result.offsets.size(), 1U);
  const PoseDifference& offset = result.offsets[0];
  EXPECT_EQ(offset.of, "second");
  EXPECT_EQ(offset.from, "first");
  // The points of all six faces: their centroid is the cube's.
  EXPECT_NEAR((offset.pivot_mm - kSecondCentre).norm(), 0.0, 1e-6);
  EXPECT_NEAR((offset.step.head<3>() - turn).norm(), 0.0, 1e-8);
  EXPECT_NEAR((offset.step.tail<3>() - shift).norm(), 0.0, 1e-7);
}

TEST(Evaluation, NoiseMovesAGroupByItsStatedUncertainty) {
  const Part part = two_cubes();
  ScanPoints scan;
  add_faces(scan, Vec3::Zero(), {}, 0.003);
  add_faces(scan, kSecondCentre, {}, 0.003);
  const PoseDifference offset = evaluate(groups(), part, scan).offsets.at(0);
  for (int k = 0; k < 6; ++k) {
    const double u = std::sqrt(offset.covariance(k, k));
    EXPECT_LT(std::abs(offset.step[k]), 4.0 * u) << k;
  }
  // 162 points of either cube hold each translation: 0.003 sqrt(2 / 162) = 0.33 um. Across the arm between
  // the cubes the rotation of the first acts with its lever too; both cubes are alike, so that half of the
  // rotation's variance is the first one's.
  const double translation = 0.003 * 0.003 * 2.0 / 162.0;
  const double arm_mm = kSecondCentre.norm();
  const double about_y = offset.covariance(1, 1) / 2.0, about_z = offset.covariance(2, 2) / 2.0;
  const double expected[3] = {translation, translation + arm_mm * arm_mm * about_z,
                              translation + arm_mm * arm_mm * about_y};
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(std::sqrt(offset.covariance(3 + k, 3 + k)), std::sqrt(expected[k]),
                0.2 * std::sqrt(expected[k]))
        << k;
}

TEST(Evaluation, AGroupSeenOnTwoFacesLeavesComponentsOpen) {
  const Part part = two_cubes();
  ScanPoints scan;
  add_faces(scan, Vec3::Zero(), {}, 0.001);
  add_faces(scan, kSecondCentre, displaced(Vec3::Zero(), Vec3(0, 0, 0.02), Vec3::Zero()), 0.001, {2});
  const PoseDifference offset = evaluate(groups(), part, scan).offsets.at(0);
  const std::array<bool, 6> expected{true, true, false, false, false, false};
  EXPECT_EQ(offset.determined, expected);
}

TEST(Evaluation, TwoViewsTogetherAndApart) {
  const Part part = two_cubes();
  const RegistrationTarget target(part);
  const RegistrationOptions options = preset("default");
  const RigidTransform tilt = displaced(Vec3(0, 0, 1e-3), Vec3(0.01, 0, 0), Vec3::Zero());
  ScanPoints first, second;
  add_faces(first, Vec3::Zero(), {}, 0.0);
  add_faces(second, Vec3::Zero(), tilt, 0.0);  // as if the table had turned too little
  const RegistrationResult of_first = register_scan(target, first, {}, options);
  const RegistrationResult of_second = register_scan(target, second, {}, options);
  const Deviations d1 = deviations_of(part, first, of_first.part_from_mcs),
                   d2 = deviations_of(part, second, of_second.part_from_mcs);
  const EvaluationResult result =
      evaluate_together({}, target, options, DeviationSurface::facets,
                        {{"a", &first, &of_first, &d1}, {"b", &second, &of_second, &d2}});
  ASSERT_TRUE(result.joint);
  EXPECT_LT(d2.outliers.count, 1U);
  EXPECT_NEAR(statistics_of(d2.signed_mm, {}).rms_mm, 0.0, 1e-7);  // by itself it fits
  EXPECT_GT(result.joint->statistics.rms_mm, 1e-3);                // together the two contradict each other
  ASSERT_EQ(result.joint->between_views.size(), 1U);
  EXPECT_NEAR(result.joint->between_views[0].step[2], 1e-3, 1e-7);
  EXPECT_EQ(result.joint->views[1].statistics.points, second.size());
}

TEST(Evaluation, DatumSurfacesAreFittedAlone) {
  const Part part = two_cubes();
  const RegistrationTarget target(part);
  ScanPoints scan;
  add_faces(scan, Vec3::Zero(), {}, 0.0);
  add_faces(scan, kSecondCentre, displaced(Vec3::Zero(), Vec3(0, 0.05, 0), Vec3::Zero()), 0.0);
  const RegistrationResult best = register_to_datum(target, scan, {}, preset("default"), {});
  const RegistrationResult on_first =
      register_to_datum(target, scan, {}, preset("default"), {0, 1, 2, 3, 4, 5});
  const RegistrationResult on_second =
      register_to_datum(target, scan, {}, preset("default"), {6, 7, 8, 9, 10, 11});
  EXPECT_NEAR(on_first.part_from_mcs.translation_mm.norm(), 0.0, 1e-7);
  EXPECT_NEAR((on_second.part_from_mcs.translation_mm - Vec3(0, -0.05, 0)).norm(), 0.0, 1e-7);
  EXPECT_EQ(on_first.first_rms_mm, best.first_rms_mm);
}

// The second cube stands 0.05 mm off. Its points are as many as the first one's, so that the best fit lies in
// between; judged from the first as the datum it is 0.05 mm off at one face and the same at the other.
TEST(Evaluation, AnOnlyViewIsJudgedFromTheDatumSurfaces) {
  const Part part = two_cubes();
  const RegistrationTarget target(part);
  const RegistrationOptions options = preset("default");
  ScanPoints scan;
  add_faces(scan, Vec3::Zero(), {}, 0.0);
  add_faces(scan, kSecondCentre, displaced(Vec3::Zero(), Vec3(0, 0.05, 0), Vec3::Zero()), 0.0);
  EvaluationSpec spec;
  spec.profiles = {{"second", {"second*"}, {-0.04, 0.04}}};
  spec.datum_surfaces = {0, 1, 2, 3, 4, 5};
  for (const bool on_datum : {false, true}) {
    const RegistrationResult own = register_to_datum(
        target, scan, {}, options, on_datum ? spec.datum_surfaces : std::vector<std::uint32_t>{});
    const Deviations deviations = deviations_of(part, scan, own.part_from_mcs);
    spec.views_on_datum = on_datum;
    const EvaluationResult result = evaluate_together(spec, target, options, DeviationSurface::facets,
                                                      {{"left", &scan, &own, &deviations}});
    ASSERT_EQ(result.profiles.size(), 1U);
    EXPECT_NEAR(result.profiles[0].profile_mm, 0.1, 1e-6) << on_datum;
    EXPECT_EQ(result.joint.has_value(), !on_datum);  // the view's own registration is all that is needed
  }
}

TEST(Evaluation, WhatFailsIsNamedAndTheRestIsMade) {
  const Part part = two_cubes();
  ScanPoints scan;
  add_faces(scan, Vec3::Zero(), {}, 0.001);
  add_faces(scan, kSecondCentre, {}, 0.001);
  EvaluationSpec spec = groups();
  spec.profiles = {{"good", {"first*"}, {-0.05, 0.05}}, {"unknown", {"vane*"}, {-0.05, 0.05}}};
  spec.sections = SectionsSpec{};
  spec.sections->heights_mm = {100.0};
  spec.groups.push_back({"third", {"12"}});
  spec.point_uncertainty_mm = 0.001;
  const EvaluationResult result = evaluate(spec, part, scan);
  ASSERT_EQ(result.profiles.size(), 1U);
  EXPECT_EQ(result.profiles[0].conformity, Conformity::conforming);
  EXPECT_EQ(result.offsets.size(), 1U);
  ASSERT_EQ(result.missing.size(), 3U);
  EXPECT_NE(result.missing[0].find("profile unknown: surface \"vane*\" does not exist"), std::string::npos);
  EXPECT_NE(result.missing[1].find("section at 100 mm"), std::string::npos);
  EXPECT_NE(result.missing[2].find("group third: surface \"12\""), std::string::npos);

  const EvaluationResult none =
      evaluate_together(spec, RegistrationTarget(part), preset("default"), DeviationSurface::facets, {});
  ASSERT_EQ(none.missing.size(), 1U);
  EXPECT_NE(none.missing[0].find("no view was registered"), std::string::npos);
}

TEST(SurfaceSelection, ByIdRangeNameAndBeginning) {
  const Part part = two_cubes();
  const auto selected = [&](std::vector<std::string> texts) { return select_surfaces(part, texts); };
  EXPECT_EQ(selected({}), (std::vector<std::uint32_t>{}));
  EXPECT_EQ(selected({"3", "1-2", "3"}), (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(selected({"second_0"}), (std::vector<std::uint32_t>{6}));
  EXPECT_EQ(selected({"second*"}), (std::vector<std::uint32_t>{6, 7, 8, 9, 10, 11}));
  for (const char* wrong : {"12", "5-12", "7-3", "second", "", "-", "1-"})
    EXPECT_THROW(selected({wrong}), InputError) << wrong;
}

}  // namespace
}  // namespace trueblade
