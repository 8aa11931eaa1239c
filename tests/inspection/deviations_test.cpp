// Covers: a sphere scanned at a known offset (closed form, both signs), a two-sided plate (the sign is that
// of the near side), the pose, surfaces, the number of threads, points that are not finite.
#include "inspection/deviations.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "geometry/error.h"
#include "geometry/random.h"
#include "tests/inspection/fixtures.h"
#include "tests/part/cad_files.h"

namespace trueblade {
namespace {

TEST(Deviations, SphereAtAKnownOffsetGivesThatOffset) {
  const Part part = sphere_part(50.0, 3);
  for (const double offset_mm : {0.25, -0.25, 0.0}) {
    const Deviations d = deviations_of(part, scan_above_facets(part, offset_mm), {});
    ASSERT_EQ(d.size(), part.model.facet_count());
    for (std::size_t i = 0; i < d.size(); ++i) {
      // A few roundings of coordinates of 50 mm: 50 * 2^-53 = 5.6e-15 mm each.
      EXPECT_NEAR(d.signed_mm[i], offset_mm, 1e-13);
      EXPECT_EQ(d.facet[i], i);
      EXPECT_EQ(d.surface[i], part.model.surface_of(static_cast<std::uint32_t>(i)));
    }
    EXPECT_EQ(d.outliers.count, 0U);
    EXPECT_EQ(d.exact, 0U);
  }
}

TEST(Deviations, PlateHasTheSignOfTheNearSide) {
  const Part part = plate_part(1.0);
  ScanPoints scan;
  scan.position_mcs_mm = {{1, 2, 0.7}, {1, 2, 0.4}, {1, 2, -0.4}, {1, 2, -0.7}, {12, 0, 0}, {13, 14, 0.5}};
  const Deviations d = deviations_of(part, scan, {});
  const double expected_mm[] = {0.2, -0.1, -0.1, 0.2, 2.0, 5.0};
  // 10 mm * 2^-53 = 1e-15 mm, a few times.
  for (std::size_t i = 0; i < d.size(); ++i) EXPECT_NEAR(d.signed_mm[i], expected_mm[i], 1e-14) << i;
  EXPECT_EQ(d.surface[1], 0U);
  EXPECT_EQ(d.surface[2], 1U);
  EXPECT_EQ(d.surface[4], 2U);
  EXPECT_NEAR(d.normal[3].z(), -1.0, 1e-15);
}

TEST(Deviations, RmsDistanceIsThatOfAllPointsAtThePose) {
  const Part part = plate_part(1.0);
  const RigidTransform lifted{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5}};
  // The distances of the plate test above, seen from half a millimetre lower.
  const std::vector<Vec3> points{{1, 2, 0.2},  {1, 2, -0.1},  {1, 2, -0.9},
                                 {1, 2, -1.2}, {12, 0, -0.5}, {13, 14, 0}};
  EXPECT_NEAR(rms_distance_mm(ClosestPointTree(part.model), points, lifted),
              std::sqrt((2 * 0.2 * 0.2 + 2 * 0.1 * 0.1 + 2.0 * 2.0 + 5.0 * 5.0) / 6.0), 1e-14);
  EXPECT_TRUE(std::isnan(rms_distance_mm(ClosestPointTree(part.model), {}, lifted)));
}

// From the CAD sphere the deviation is the radius less 8 mm, whatever its facets are; from the facets, which
// lie up to a chord error inside, it is larger.
TEST(Deviations, FromTheExactSurfaceOfASphereIsThatOfTheClosedForm) {
  const TemporaryFolder folder;
  write_test_shape(TestShape::sphere, folder / "sphere.step");
  const Part part = read_part(folder / "sphere.step", {});
  const Vec3 centre(1.0, 2.0, 3.0);
  Rng rng(8, 0, "beside the sphere");
  ScanPoints scan;
  std::vector<double> expected_mm;
  for (int i = 0; i < 2000; ++i) {
    expected_mm.push_back(0.1 * (rng.uniform() - 0.5));
    scan.position_mcs_mm.push_back(centre + (8.0 + expected_mm.back()) * rng.normal_vector().normalized());
  }
  const Deviations d = deviations_of(part, scan, {});
  EXPECT_EQ(d.exact, d.size());
  double most_mm = 0.0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    EXPECT_NEAR(d.signed_mm[i], expected_mm[i], 1e-11);  // coordinates of 11 mm, and 15 digits in STEP
    EXPECT_LT((d.normal[i] - (scan.position_mcs_mm[i] - centre).normalized()).norm(), 1e-9);
    const double chord_mm = d.from_facets_mm[i] - d.signed_mm[i];
    EXPECT_GT(chord_mm, -1e-11);
    EXPECT_LT(chord_mm, part.chord_tolerance_mm);
    most_mm = std::max(most_mm, chord_mm);
  }
  EXPECT_GT(most_mm, 0.2 * part.chord_tolerance_mm);
}

TEST(Deviations, ArePoseTimesPoint) {
  const Part part = sphere_part(50.0, 3);
  const RigidTransform part_from_mcs{rotation_from_vector({0.3, -0.2, 0.9}), {10.0, -20.0, 5.0}};
  ScanPoints scan = scan_above_facets(part, 0.125);
  const RigidTransform mcs_from_part = part_from_mcs.inverse();
  for (Vec3& p : scan.position_mcs_mm) p = mcs_from_part * p;
  const Deviations d = deviations_of(part, scan, part_from_mcs);
  // Rotating forth and back: ten roundings of 75 mm, 75 * 2^-53 = 8.3e-15 mm each.
  for (const double signed_mm : d.signed_mm) EXPECT_NEAR(signed_mm, 0.125, 1e-13);
}

TEST(Deviations, DoNotDependOnTheNumberOfThreads) {
  const Part part = sphere_part(20.0, 3);
  ScanPoints scan;
  Rng rng(7, 0, std::uint64_t{0});
  for (int i = 0; i < 3000; ++i) scan.position_mcs_mm.push_back(12.0 * rng.normal_vector());
  const auto run = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return deviations_of(part, scan, {});
  };
  const Deviations one = run(1), four = run(4);
  EXPECT_EQ(one.signed_mm, four.signed_mm);
  EXPECT_EQ(one.facet, four.facet);
  EXPECT_EQ(one.outliers.is_outlier, four.outliers.is_outlier);
}

TEST(Deviations, RefusePointsAndPosesThatAreNotFinite) {
  const Part part = plate_part(1.0);
  ScanPoints scan;
  scan.position_mcs_mm = {{0, 0, 1}, {0, std::nan(""), 1}};
  EXPECT_THROW(deviations_of(part, scan, {}), InputError);
  scan.position_mcs_mm.pop_back();
  EXPECT_THROW(deviations_of(part, scan, {Eigen::Quaterniond::Identity(), {0, INFINITY, 0}}), InputError);
}

TEST(DeviationSurface, NamesReadBack) {
  for (const auto surface : {DeviationSurface::facets, DeviationSurface::exact}) {
    EXPECT_EQ(parse_deviation_surface(to_string(surface)), surface);
  }
  EXPECT_THROW(parse_deviation_surface("cad"), InputError);
}

}  // namespace
}  // namespace trueblade
