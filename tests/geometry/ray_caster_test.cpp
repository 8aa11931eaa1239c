// The ray caster: closed forms on planes and spheres, the slow twin (every facet, in double), rays through
// edges and nodes, limits to the last bit, and scenes where float alone would fail.
#include "geometry/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "geometry/random.h"
#include "geometry/rigid_transform.h"
#include "tests/geometry/search_shapes.h"
#include "tests/geometry/shapes.h"

namespace trueblade {
namespace {

constexpr double kUlp = 0x1p-52;  // of 1
constexpr double kInfinity = std::numeric_limits<double>::infinity();

FacetModel model_of(const FacetSoup& soup) {
  return build_facet_model(soup, 0.0).model;
}

FacetSoup moved(FacetSoup soup, const RigidTransform& part_from_soup) {
  for (Vec3& node : soup.nodes_mm) node = part_from_soup * node;
  return soup;
}

RigidTransform random_pose(Rng& rng, double far_mm) {
  return {rotation_from_vector(3.0 * rng.normal_vector()), far_mm * rng.normal_vector()};
}

// The slow twin: Moeller and Trumbore (1997) in double on every facet.
double brute_force_range(const FacetModel& model, const Ray& ray) {
  double first = kInfinity;
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
    const auto [a, b, c] = model.corners_mm(facet);
    const Vec3 p = ray.direction.cross(c - a);
    const double det = p.dot(b - a);
    const double u = p.dot(ray.origin_mm - a) / det;
    const Vec3 q = (ray.origin_mm - a).cross(b - a);
    const double v = q.dot(ray.direction) / det;
    const double range = q.dot(c - a) / det;
    if (det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range >= 0.0) first = std::min(first, range);
  }
  return first;
}

// Rounding of the origin, of the difference to the facet and of two scalar products: at most eight ulps of
// the range, made longer by the slope of the ray against the facet.
double range_rounding_mm(double range_mm, double largest_coordinate_mm, double cos_incidence) {
  return 8.0 * kUlp * (range_mm + largest_coordinate_mm) / cos_incidence;
}

TEST(RayCaster, PlaneIsExactToRoundingUpToGrazing) {
  Rng rng(1, 0, "plane");
  for (int trial = 0; trial < 20; ++trial) {
    const RigidTransform part_from_sheet = random_pose(rng, 50.0);
    const RayCaster caster(model_of(moved(shapes::sheet(40, 40), part_from_sheet)));
    for (const double incidence_deg : {0.0, 30.0, 60.0, 80.0, 89.0, 89.9, 89.99}) {
      const double incidence = incidence_deg * std::numbers::pi / 180.0;
      const double azimuth = 6.28 * rng.uniform();
      const double range_mm = 100.0 + 400.0 * rng.uniform();
      const Vec3 target_mm(10.0 + 20.0 * rng.uniform(), 10.0 + 20.0 * rng.uniform(), 0.0);
      const Vec3 towards(std::sin(incidence) * std::cos(azimuth), std::sin(incidence) * std::sin(azimuth),
                         -std::cos(incidence));
      const Ray ray{part_from_sheet * (target_mm - range_mm * towards), part_from_sheet.rotation * towards};
      const auto hit = caster.first_hit(ray, 0.0, 1000.0);
      ASSERT_TRUE(hit) << incidence_deg;
      // At 500 mm and 89.99 degrees this is 8e-9 mm, where float alone is off by millimetres.
      EXPECT_NEAR(hit->range_mm, range_mm, range_rounding_mm(range_mm, 700.0, std::cos(incidence)))
          << incidence_deg;
      EXPECT_NEAR((hit->normal - part_from_sheet.rotation * Vec3::UnitZ()).norm(), 0.0, 1e-12);
    }
  }
}

TEST(RayCaster, AgreesWithBruteForce) {
  const FacetModel model = model_of(shapes::sphere(40.0, 3, {3.0, -5.0, 7.0}));
  const RayCaster caster(model);
  Rng rng(2, 0, "sphere");
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 origin_mm = 300.0 * rng.normal_vector().normalized();
    const Vec3 target_mm = 30.0 * rng.normal_vector();
    const Ray ray{origin_mm, (target_mm - origin_mm).normalized()};
    const double expected = brute_force_range(model, ray);
    const auto hit = caster.first_hit(ray, 0.0, 1000.0);
    ASSERT_EQ(hit.has_value(), std::isfinite(expected)) << i;
    if (!hit) continue;
    ++hits;
    const double cos_incidence = std::abs(hit->normal.dot(ray.direction));
    EXPECT_NEAR(hit->range_mm, expected, range_rounding_mm(expected, 300.0, cos_incidence)) << i;
    // The barycentric weights name the same point as the range.
    const auto [a, b, c] = model.corners_mm(hit->facet);
    const Vec3 point_mm = a + hit->barycentric.x() * (b - a) + hit->barycentric.y() * (c - a);
    EXPECT_NEAR((point_mm - ray.origin_mm - hit->range_mm * ray.direction).norm(), 0.0,
                4.0 * range_rounding_mm(expected, 300.0, cos_incidence));
    EXPECT_GT(hit->normal.dot(point_mm - Vec3(3.0, -5.0, 7.0)), 0.0);  // outward
  }
  EXPECT_GT(hits, 1000);
  EXPECT_LT(hits, 3900);
}

// Through every node and along every edge of a closed body, from inside and from outside, near and kilometres
// from the origin: never a leak, and the right range.
TEST(RayCaster, EdgesAndNodesDoNotLeak) {
  Rng rng(3, 0, "edges");
  for (const double far_mm : {0.0, 100.0, 5e6}) {
    const Vec3 centre_mm = far_mm * rng.normal_vector();
    const FacetModel model = model_of(shapes::sphere(20.0, 2, centre_mm));
    const RayCaster caster(model);
    for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
      const std::array<Vec3, 3> corners = model.corners_mm(facet);
      for (int k = 0; k < 3; ++k) {
        for (const double t : {0.0, 1e-9, 0.25, 0.5}) {
          const Vec3 target_mm = corners[k] + t * (corners[(k + 1) % 3] - corners[k]);
          const Vec3 outward = (target_mm - centre_mm).normalized();
          const Vec3 across = outward.unitOrthogonal();
          for (const Vec3& direction : {outward, Vec3(-outward), (0.8 * across - 0.6 * outward).eval()}) {
            const Ray ray{target_mm - 10.0 * direction, direction};
            const auto hit = caster.first_hit(ray, 0.0, 15.0);
            ASSERT_TRUE(hit) << far_mm << " " << facet << " " << k << " " << t;
            EXPECT_NEAR(hit->range_mm, 10.0, range_rounding_mm(10.0, centre_mm.norm() + 30.0, 0.5));
          }
        }
      }
    }
  }
}

TEST(RayCaster, NoRayLeavesAClosedBody) {
  const RayCaster caster(model_of(shapes::sphere(20.0, 4)));
  Rng rng(4, 0, "inside");
  for (int i = 0; i < 50'000; ++i) {
    const Ray ray{5.0 * rng.normal_vector().normalized(), rng.normal_vector().normalized()};
    ASSERT_TRUE(caster.first_hit(ray, 0.0, 100.0)) << i;
  }
}

TEST(RayCaster, LimitsHoldToTheLastBit) {
  const RayCaster caster(model_of(shapes::cube(2.0)));
  const Ray ray{{0.5, 0.75, -10.0}, Vec3::UnitZ()};  // meets the cube at 10 and 12, exactly
  const auto range = [&](double least, double most) -> double {
    const auto hit = caster.first_hit(ray, least, most);
    return hit ? hit->range_mm : -1.0;
  };
  const double above_10 = std::nextafter(10.0, 11.0), below_10 = std::nextafter(10.0, 9.0);
  EXPECT_EQ(range(0.0, 100.0), 10.0);
  EXPECT_EQ(range(10.0, 10.0), 10.0);
  EXPECT_EQ(range(0.0, below_10), -1.0);
  EXPECT_EQ(range(above_10, 100.0), 12.0);
  EXPECT_EQ(range(above_10, 11.0), -1.0);
  EXPECT_EQ(range(12.0, kInfinity), 12.0);
  EXPECT_EQ(range(std::nextafter(12.0, 13.0), kInfinity), -1.0);
  EXPECT_EQ(range(13.0, 12.0), -1.0);
}

// Two sheets 1e-9 mm apart: float cannot tell them apart, the limits can.
TEST(RayCaster, LimitsSeparateSheetsThatFloatDoesNot) {
  FacetSoup soup = shapes::sheet(10, 10);
  FacetSoup upper = shapes::sheet(10, 10);
  for (Vec3& node : upper.nodes_mm) node.z() = 1e-9;
  shapes::append(soup, upper);
  const RayCaster caster(model_of(soup));
  const Ray ray{{5.3, 5.1, 8.0}, -Vec3::UnitZ()};
  const auto lower = caster.first_hit(ray, 8.0, 9.0);
  ASSERT_TRUE(lower);
  EXPECT_EQ(lower->range_mm, 8.0);
  const auto top = caster.first_hit(ray, 0.0, std::nextafter(8.0, 0.0));
  ASSERT_TRUE(top);
  EXPECT_NEAR(top->range_mm, 8.0 - 1e-9, 16.0 * kUlp);
}

TEST(RayCaster, BothSidesAreHitAndTheNormalStaysOutward) {
  const RayCaster caster(model_of(shapes::cube(2.0)));
  const auto from_inside = caster.first_hit({{1.1, 0.9, 1.0}, Vec3::UnitX()}, 0.0, 10.0);
  ASSERT_TRUE(from_inside);
  EXPECT_EQ(from_inside->normal, Vec3::UnitX());
  EXPECT_EQ(from_inside->range_mm, 2.0 - 1.1);
  EXPECT_FALSE(caster.first_hit({{1.1, 0.9, 3.0}, Vec3::UnitX()}, 0.0, 10.0));
}

// The closed form of a sphere, over the whole range of sizes, and from a probe ten kilometres away.
TEST(RayCaster, SizeAndDistanceDoNotMatter) {
  for (const double radius_mm : {1e-6, 1.0, 1e7}) {
    const RayCaster caster(model_of(shapes::sphere(radius_mm, 5)));
    const Ray ray{{0.3 * radius_mm, 0.2 * radius_mm, -1e7}, Vec3::UnitZ()};
    const auto hit = caster.first_hit(ray, -kInfinity, kInfinity);
    ASSERT_TRUE(hit) << radius_mm;
    // Chord error: edge angle 1.11 rad / 2^5 = 0.035 rad at most 0.04, sagitta below 0.04^2 / 6 of the
    // radius; along the ray a factor 1 / cos(incidence) = 1 / 0.93.
    EXPECT_NEAR(hit->range_mm, 1e7 - radius_mm * std::sqrt(1.0 - 0.13), 3e-4 * radius_mm + 8.0 * kUlp * 1e7);
  }
}

TEST(RayCaster, RaysThatAreNoneMiss) {
  const RayCaster caster(model_of(shapes::cube(2.0)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(caster.first_hit({Vec3::Ones(), Vec3::Zero()}, 0.0, 10.0));
  EXPECT_FALSE(caster.first_hit({Vec3::Ones(), {nan, 0.0, 1.0}}, 0.0, 10.0));
  EXPECT_FALSE(caster.first_hit({{1.0, nan, 1.0}, Vec3::UnitZ()}, 0.0, 10.0));
  EXPECT_FALSE(caster.first_hit({{1.0, kInfinity, 1.0}, -Vec3::UnitY()}, 0.0, 10.0));
  EXPECT_FALSE(caster.first_hit({Vec3::Ones(), Vec3::UnitZ()}, nan, 10.0));
  EXPECT_FALSE(caster.first_hit({Vec3::Ones(), Vec3::UnitZ()}, 0.0, nan));
}

TEST(RayCaster, ThreadsDoNotChangeTheAnswer) {
  const RayCaster caster(model_of(shapes::sphere(20.0, 4)));
  constexpr std::size_t kRays = 20'000;
  const auto range = [&](std::size_t i) {
    Rng rng = Rng(5, 0, "threads").at(6 * i);
    const Vec3 origin_mm = 100.0 * rng.normal_vector().normalized();
    const auto hit =
        caster.first_hit({origin_mm, (15.0 * rng.normal_vector() - origin_mm).normalized()}, 0.0, 200.0);
    return hit ? hit->range_mm : -1.0;
  };
  std::vector<double> parallel(kRays);
  parallel_for_blocks(kRays, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) parallel[i] = range(i);
  });
  for (std::size_t i = 0; i < kRays; ++i) ASSERT_EQ(parallel[i], range(i)) << i;
}

TEST(RayCaster, ManyRaysHitWhatEachHits) {
  const FacetModel model = model_of(shapes::torus(10.0, 4.0, 60, 24));
  const RayCaster caster(model);
  Rng rng(9, 0, "many rays");
  std::vector<Ray> rays;
  for (int i = 0; i < 1003; ++i) {  // some of them miss; not a multiple of any packet
    const Vec3 origin_mm = 40.0 * rng.normal_vector().normalized();
    rays.push_back({origin_mm, (9.0 * rng.normal_vector() - origin_mm).normalized()});
  }
  rays[5].direction = Vec3::Zero();
  rays[17].origin_mm.x() = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [least_mm, most_mm] : {std::pair(0.0, kInfinity), std::pair(33.0, 37.0)}) {
    std::vector<std::optional<RayHit>> hits(rays.size());
    caster.first_hits(rays, least_mm, most_mm, hits);
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto alone = caster.first_hit(rays[i], least_mm, most_mm);
      ASSERT_EQ(hits[i].has_value(), alone.has_value()) << i;
      if (!alone) continue;
      ++count;
      EXPECT_EQ(hits[i]->facet, alone->facet);
      EXPECT_EQ(hits[i]->range_mm, alone->range_mm);
      EXPECT_EQ(hits[i]->normal, alone->normal);
      EXPECT_EQ(hits[i]->barycentric, alone->barycentric);
    }
    EXPECT_GT(count, 100U);
    EXPECT_LT(count, 1000U);
  }
}

// A line between two points outside a sphere is blocked where it passes the centre nearer than the radius.
// The facets (edges of 1.4 mm) lie within 1.4^2 / (2 * 20) = 0.05 mm below the sphere.
TEST(RayCaster, ALineOfSightIsBlockedByWhatStandsOnIt) {
  const RayCaster caster(model_of(shapes::sphere(20.0, 4)));
  Rng rng(5, 0, "lines of sight");
  std::vector<LineOfSight> lines;
  for (int i = 0; i < 2000; ++i)
    lines.push_back({40.0 * rng.normal_vector().normalized(), 25.0 * rng.normal_vector().normalized()});
  const auto blocked = std::make_unique<bool[]>(lines.size());
  caster.blocked_lines(lines, {blocked.get(), lines.size()});
  std::size_t count = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Vec3 way_mm = lines[i].to_mm - lines[i].from_mm;
    const double nearest = std::clamp(-lines[i].from_mm.dot(way_mm) / way_mm.squaredNorm(), 0.0, 1.0);
    const double from_centre_mm = (lines[i].from_mm + nearest * way_mm).norm();
    if (from_centre_mm > 19.95 && from_centre_mm < 20.0) continue;
    EXPECT_EQ(blocked[i], from_centre_mm < 20.0) << i;
    count += blocked[i] ? 1 : 0;
  }
  EXPECT_GT(count, 500U);
  EXPECT_LT(count, 1800U);
}

}  // namespace
}  // namespace trueblade
