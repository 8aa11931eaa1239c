// Closest points on CAD surfaces: against closed forms for planes, cylinders, spheres and a torus, and
// against the CAD kernel's own distances for B-splines.
#include "part/exact_closest_point.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "geometry/closest_point_tree.h"
#include "geometry/random.h"
#include "part/turbine_blade.h"
#include "tests/part/cad_files.h"
#include "tests/part/kernel_distance.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

Part read_shape(TestShape shape) {
  const TemporaryFolder folder;
  write_test_shape(shape, folder / "shape.step");
  return read_part(folder / "shape.step", {});
}

// Beside random places of random facets, up to `height_mm` to either side; every second place is drawn to an
// edge of its facet, so that borders of surfaces are met often.
std::vector<Vec3> points_beside(const FacetModel& model, std::size_t count, double height_mm) {
  Rng random(3, 0, "points beside facets");
  std::vector<Vec3> points_mm;
  while (points_mm.size() < count) {
    const auto facet =
        static_cast<std::uint32_t>(random.uniform() * static_cast<double>(model.facet_count()));
    const auto [a, b, c] = model.corners_mm(facet);
    double v = random.uniform(), w = random.uniform();
    if (v + w > 1.0) continue;
    if (points_mm.size() % 2 == 0) v *= 0.01;
    points_mm.push_back(a + v * (b - a) + w * (c - a) +
                        height_mm * (2.0 * random.uniform() - 1.0) * model.facet_normal(facet));
  }
  return points_mm;
}

// Coordinates up to 30 mm have 4e-15 mm of rounding, and STEP writes 15 digits of them: 1e-13 mm.
constexpr double kRounding_mm = 1e-11;

void expect_distances(const Part& part, const std::vector<Vec3>& points_mm, double tolerance_mm,
                      const std::function<double(const Vec3&)>& signed_distance_mm) {
  const ClosestPointTree tree(part.model);
  for (const Vec3& p : points_mm) {
    const auto exact = refine_to_exact(part, tree.query(p), p);
    ASSERT_TRUE(exact) << p.transpose();
    ASSERT_NEAR(exact->distance_mm, signed_distance_mm(p), tolerance_mm) << p.transpose();
    ASSERT_NEAR(exact->foot.normal.norm(), 1.0, 1e-14);
    // Foot point and normal are the way to the query. A foot point is off by 1e-9 mm along the surface at
    // most.
    ASSERT_LT((exact->foot.point_mm + exact->distance_mm * exact->foot.normal - p).norm(), 2e-9);
  }
}

// Planes, cylinders and spheres that meet without kinks: the distance is that of a smaller box, less 2 mm.
TEST(ExactClosestPoint, OfTheFilletedBoxIsThatOfTheClosedForm) {
  constexpr double kFillet = 2.0;
  const Part part = read_shape(TestShape::filleted_box);
  const Vec3 half(5.0, 10.0, 15.0);
  // A face counts up to 1/64 of the chord tolerance beyond its border, where the fillet bends away from the
  // plane.
  const double beyond_border_mm = part.chord_tolerance_mm / 64.0;
  const double tolerance_mm = beyond_border_mm * beyond_border_mm / (2.0 * kFillet) + kRounding_mm;
  expect_distances(part, points_beside(part.model, 20000, 0.05), tolerance_mm, [&](const Vec3& p) {
    const Vec3 beyond = (p - half).cwiseAbs() - (half - Vec3::Constant(kFillet));
    return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0) - kFillet;
  });
}

TEST(ExactClosestPoint, OfTheSphereIsThatOfTheClosedForm) {
  const Part part = read_shape(TestShape::sphere);
  expect_distances(part, points_beside(part.model, 5000, 0.05), kRounding_mm,
                   [](const Vec3& p) { return (p - Vec3(1, 2, 3)).norm() - 8.0; });
}

TEST(ExactClosestPoint, OfTheTorusIsThatOfTheClosedForm) {
  const Part part = read_shape(TestShape::torus);
  expect_distances(part, points_beside(part.model, 5000, 0.05), kRounding_mm,
                   [](const Vec3& p) { return std::hypot(p.head<2>().norm() - 10.0, p.z()) - 3.0; });
}

// All around the box, as far as its facets may be wrong and beyond, outside and inside: faces, edges and
// corners.
TEST(ExactClosestPoint, OfTheBoxIsThatOfTheClosedForm) {
  const Part part = read_shape(TestShape::box);
  const ClosestPointTree tree(part.model);
  const Vec3 half(5.0, 10.0, 15.0);
  Rng random(6, 0, "around a box");
  std::array<int, 4> beyond_how_many_faces{};
  for (int k = 0; k < 20000; ++k) {
    const double away_mm = std::pow(10.0, -4.0 + 4.0 * random.uniform());
    Vec3 p;  // from the middle of the box
    for (int axis = 0; axis < 3; ++axis) {
      const double at_border_mm = half[axis] + away_mm * (2.0 * random.uniform() - 1.0);
      p[axis] = (random.uniform() < 0.5 ? -1.0 : 1.0) *
                (k % 3 == axis ? half[axis] * random.uniform() : at_border_mm);
      if (k % 7 == 0) p[axis] = std::copysign(at_border_mm, p[axis]);  // near a corner
    }
    const Vec3 beyond = p.cwiseAbs() - half;
    const double expected_mm = beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
    ++beyond_how_many_faces[static_cast<std::size_t>((beyond.array() > 0.0).count())];
    const Vec3 query = p + half;
    const ClosestPoint on_facets = tree.query(query);
    const auto exact = refine_to_exact(part, on_facets, query);
    // Plane facets are exact: at a corner their answer stands.
    const double found_mm = exact ? exact->distance_mm : on_facets.distance_mm;
    // At a corner faces and edges count up to t = 1/64 of the chord tolerance beyond their ends. Where all
    // three faces do, the answers lie between -t and sqrt(3) t.
    const double t_mm = part.chord_tolerance_mm / 64.0;
    const double tolerance_mm = beyond.minCoeff() > -t_mm ? 2.74 * t_mm : 1e-9;
    ASSERT_NEAR(found_mm, expected_mm, tolerance_mm) << p.transpose();
    if (!exact) continue;
    ASSERT_LT((exact->foot.point_mm + exact->distance_mm * exact->foot.normal - query).norm(), 1e-6);
  }
  for (const int count : beyond_how_many_faces) EXPECT_GT(count, 300);
}

// The upper rim of the cylinder, radius 5 at z = 12, from beyond both of its faces.
TEST(ExactClosestPoint, OfTheRimIsThatOfTheClosedForm) {
  const Part part = read_shape(TestShape::cylinder);
  const ClosestPointTree tree(part.model);
  Rng random(7, 0, "beyond a rim");
  for (int k = 0; k < 5000; ++k) {
    const double angle = 6.283185307179586 * random.uniform();
    const double outward_mm = std::pow(10.0, -3.0 + 2.0 * random.uniform());
    const double upward_mm = std::pow(10.0, -3.0 + 2.0 * random.uniform());
    const Vec3 query((5.0 + outward_mm) * std::cos(angle), (5.0 + outward_mm) * std::sin(angle),
                     12.0 + upward_mm);
    const auto exact = refine_to_exact(part, tree.query(query), query);
    ASSERT_TRUE(exact) << query.transpose();
    ASSERT_NEAR(exact->distance_mm, std::hypot(outward_mm, upward_mm), 1e-9) << query.transpose();
    ASSERT_LT((exact->foot.point_mm - Vec3(5.0 * std::cos(angle), 5.0 * std::sin(angle), 12.0)).norm(), 1e-8);
  }
}

// Wherever the last step begins, and however near the pole, where it is none that a series could make.
TEST(ExactClosestPoint, ProjectionsOntoTheSphereArriveFromEveryShortDistance) {
  const Part part = read_shape(TestShape::sphere);
  const Vec3 centre(1, 2, 3);
  Rng random(4, 0, "short starts");
  for (const double pole_distance : {1.0, 1e-3, 1e-6, 1e-9})
    for (int k = 0; k < 2000; ++k) {
      const Vec2 uv(6.2 * random.uniform(),
                    0.5 * 3.14159265358979 - pole_distance * (1.0 + random.uniform()));
      const Vec3 radial = (part.exact->evaluate(0, uv).point_mm - centre) / 8.0;
      const double height_mm = 0.1 * random.uniform() - 0.05;
      const Vec3 query = centre + (8.0 + height_mm) * radial;
      const double away = std::pow(10.0, -1.0 - 8.0 * random.uniform());
      const Vec2 start = uv + away * pole_distance * Vec2(random.uniform() - 0.5, random.uniform() - 0.5);
      const auto foot = part.exact->project(0, query, start);
      ASSERT_TRUE(foot.converged);
      ASSERT_NEAR(foot.distance_mm, std::abs(height_mm), 1e-13);
      ASSERT_LT((foot.foot.point_mm - (centre + 8.0 * radial)).norm(), 1e-9);
      ASSERT_LT((foot.foot.normal - radial).norm(), 1e-9);
    }
}

TEST(ExactClosestPoint, OfTheBladeIsThatOfTheCadKernel) {
  const TemporaryFolder folder;
  write_turbine_blade({}, folder / "blade.step");
  const Part part = read_part(folder / "blade.step", {});
  const std::vector<Vec3> points_mm = points_beside(part.model, 100, 0.02);
  const std::vector<double> kernel_mm = kernel_distances_mm(folder / "blade.step", points_mm);
  const ClosestPointTree tree(part.model);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const auto exact = refine_to_exact(part, tree.query(points_mm[i]), points_mm[i]);
    if (!exact) continue;  // nearest to an edge
    EXPECT_NEAR(std::abs(exact->distance_mm), kernel_mm[i], 1e-9) << points_mm[i].transpose();
    ++compared;
  }
  EXPECT_GT(compared, 90u);
}

}  // namespace
}  // namespace trueblade
