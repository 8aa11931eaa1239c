// Closest-point tree: closed forms; the brute force on models made to mislead it, near and far; and its own
// promise, that an answer does not depend on how it was found: cold, warm, in any order, from the certified
// cache after any motion, by any number of threads, with any instruction set - to the last bit.
#include "geometry/closest_point_tree.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <string_view>

#include "geometry/error.h"
#include "geometry/rigid_transform.h"
#include "geometry/spatial_order.h"
#include "tests/geometry/search_shapes.h"

namespace trueblade {
namespace {

// Distances are differences of coordinates of size s followed by some thirty operations, in the tree and in
// the brute force: 64 ulps of s. That is 1.4e-12 mm at s = 100 mm.
double rounding_mm(const FacetModel& model, const Vec3& query_mm) {
  const double s = std::max({model.lower_corner_mm().cwiseAbs().maxCoeff(),
                             model.upper_corner_mm().cwiseAbs().maxCoeff(), query_mm.cwiseAbs().maxCoeff()});
  return 64.0 * 0x1p-52 * s;
}

bool same_bits(const ClosestPoint& a, const ClosestPoint& b) {
  return a.point_mm == b.point_mm && a.distance_mm == b.distance_mm && a.facet == b.facet &&
         a.feature == b.feature;
}

std::vector<ClosestPoint> cold_answers(const ClosestPointTree& tree, const std::vector<Vec3>& queries) {
  std::vector<ClosestPoint> closest(queries.size());
  ClosestPointWork work;
  tree.query(queries, closest, {}, work);
  return closest;
}

void expect_is_closest(const FacetModel& model, const Vec3& query, const ClosestPoint& found,
                       const ClosestPoint& truth) {
  const double tolerance = rounding_mm(model, query);
  EXPECT_NEAR(found.distance_mm, truth.distance_mm, tolerance);
  EXPECT_NEAR((query - found.point_mm).norm(), found.distance_mm, tolerance);
  ASSERT_LT(found.facet, model.facet_count());
  const auto [a, b, c] = model.corners_mm(found.facet);
  EXPECT_NEAR((closest_point_on_facet(a, b, c, query).point_mm - query).norm(), truth.distance_mm, tolerance);
}

TEST(ClosestPointTree, PlaneInClosedForm) {
  const FacetModel model = build_facet_model(shapes::sheet(40, 30), 0.0).model;
  const ClosestPointTree tree(model);
  Rng rng(1, 0, "plane");
  for (int i = 0; i < 2000; ++i) {
    const Vec3 foot(40.0 * rng.uniform(), 30.0 * rng.uniform(), 0.0);
    const double height = 20.0 * rng.normal();
    const ClosestPoint closest = tree.query(foot + Vec3(0.0, 0.0, height));
    EXPECT_EQ(closest.distance_mm, std::abs(height));  // the sheet's coordinates are whole numbers: exact
    EXPECT_LT((closest.point_mm - foot).norm(), 64.0 * 0x1p-52 * 40.0);
  }
}

// Two plates of 30 x 20 mm that meet in the y axis: the distance is the lesser one of two rectangles'.
TEST(ClosestPointTree, WedgeInClosedForm) {
  for (const double angle_rad : {0.05, 0.7, 2.5}) {
    SCOPED_TRACE(angle_rad);
    const FacetModel model = build_facet_model(shapes::wedge(30, 20, angle_rad), 0.0).model;
    const ClosestPointTree tree(model);
    const auto distance_mm = [](const Vec3& p) {  // from the rectangle in the plane z = 0
      const Vec3 foot(std::clamp(p.x(), 0.0, 30.0), std::clamp(p.y(), 0.0, 20.0), 0.0);
      return (p - foot).norm();
    };
    const Eigen::AngleAxisd lower_into_plane(-angle_rad, Vec3::UnitY());
    Rng rng(2, 0, "wedge");
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p(45.0 * rng.uniform() - 10.0, 30.0 * rng.uniform() - 5.0, 40.0 * rng.uniform() - 25.0);
      EXPECT_NEAR(tree.query(p).distance_mm, std::min(distance_mm(p), distance_mm(lower_into_plane * p)),
                  rounding_mm(model, p));
    }
  }
}

// Facets with their nodes on a round surface lie within their chord error inside it, where it is convex, and
// so does the distance: a bracket in closed form, at most a hundredth of the distances that it holds.
TEST(ClosestPointTree, RoundSurfacesWithinTheirChordError) {
  struct RoundShape {
    const char* name;
    FacetModel model;
    double chord_error_mm;
    std::function<double(const Vec3&)> signed_distance_mm;
  };
  constexpr std::uint32_t kAround = 360, kAcross = 90;
  const auto sagitta_mm = [](double radius_mm, std::uint32_t around) {
    return radius_mm * (1.0 - std::cos(std::numbers::pi / around));
  };
  const FacetModel sphere = build_facet_model(shapes::sphere(40.0, 5), 0.0).model;
  const auto nearest_plane_mm = [](const FacetModel& model) {  // to the origin
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t f = 0; f < model.facet_count(); ++f)
      nearest = std::min(nearest, model.facet_normal(f).dot(model.corners_mm(f)[0]));
    return nearest;
  };
  const RoundShape rounds[] = {
      {"sphere", sphere, 40.0 - nearest_plane_mm(sphere), [](const Vec3& p) { return p.norm() - 40.0; }},
      {"cylinder", build_facet_model(shapes::cylinder(15.0, 50.0, kAround), 0.0).model,
       sagitta_mm(15.0, kAround), [](const Vec3& p) { return p.head<2>().norm() - 15.0; }},
      {"torus", build_facet_model(shapes::torus(40.0, 10.0, kAround, kAcross), 0.0).model,
       sagitta_mm(50.0, kAround) + sagitta_mm(10.0, kAcross),
       [](const Vec3& p) { return std::hypot(p.head<2>().norm() - 40.0, p.z()) - 10.0; }}};
  for (const auto& [name, model, chord_error_mm, signed_distance_mm] : rounds) {
    SCOPED_TRACE(name);
    const ClosestPointTree tree(model);
    Rng rng(3, 0, "round surfaces");
    int compared = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 p = 30.0 * rng.normal_vector();
      const double expected_mm = signed_distance_mm(p);
      if (std::string_view(name) == "cylinder" && std::abs(p.z()) > 25.0) continue;  // beyond its rims
      if (std::abs(expected_mm) < 100.0 * chord_error_mm) continue;
      EXPECT_NEAR(tree.query(p).distance_mm, std::abs(expected_mm), chord_error_mm + rounding_mm(model, p))
          << p.transpose();
      ++compared;
    }
    EXPECT_GT(compared, 1000);
  }
}

TEST(ClosestPointTree, EqualsBruteForce) {
  for (const auto& [name, model] : shapes::search_models()) {
    SCOPED_TRACE(name);
    const ClosestPointTree tree(model);
    const std::vector<Vec3> queries = shapes::search_queries(model, 800, 11);
    const std::vector<ClosestPoint> closest = cold_answers(tree, queries);
    for (std::size_t i = 0; i < queries.size(); ++i)
      expect_is_closest(model, queries[i], closest[i], closest_point_brute_force(model, queries[i]));
  }
}

// The feature is the one of the model's own corner numbers: the closest point lies on it.
TEST(ClosestPointTree, NamesTheFeature) {
  for (const auto& [name, model] : shapes::search_models()) {
    SCOPED_TRACE(name);
    const ClosestPointTree tree(model);
    std::array<int, 7> seen{};
    for (const Vec3& query : shapes::search_queries(model, 400, 12)) {
      const ClosestPoint closest = tree.query(query);
      const auto corners = model.corners_mm(closest.facet);
      const auto feature = static_cast<std::size_t>(closest.feature);
      ++seen[feature];
      if (feature >= 4) {
        EXPECT_EQ(closest.point_mm, corners[feature - 4]);
      } else if (feature >= 1) {
        const Vec3 &from = corners[feature - 1], along = corners[feature % 3] - from;
        const double t = (closest.point_mm - from).dot(along) / along.squaredNorm();
        EXPECT_NEAR((from + t * along - closest.point_mm).norm(), 0.0, rounding_mm(model, query));
        EXPECT_GE(t, 0.0);
        EXPECT_LE(t, 1.0);
      }
    }
    EXPECT_GT(seen[0], 0);
    EXPECT_GT(seen[1] + seen[2] + seen[3], 0);
    EXPECT_GT(seen[4] + seen[5] + seen[6], 0);
  }
}

// 10 m from the origin coordinates have ulps of 1.8e-12 mm, but their differences are exact: moving a model
// whose coordinates are multiples of 2^-10 by a whole number changes no distance by a bit.
TEST(ClosestPointTree, KeepsItsPrecisionFarFromTheOrigin) {
  FacetSoup soup = shapes::torus(40.0, 10.0, 60, 24);
  for (Vec3& node : soup.nodes_mm) node = (node * 1024.0).array().round().matrix() / 1024.0;
  const Vec3 offset(10000.0, -20000.0, 8192.0);
  const FacetModel near = build_facet_model(soup, 0.0).model;
  for (Vec3& node : soup.nodes_mm) node += offset;
  const FacetModel far = build_facet_model(soup, 0.0).model;
  const ClosestPointTree near_tree(near), far_tree(far);
  for (Vec3 query : shapes::search_queries(near, 400, 13)) {
    if (query.norm() > 1e5) continue;
    query = (query * 1024.0).array().round().matrix() / 1024.0;
    EXPECT_EQ(far_tree.query(query + offset).distance_mm, near_tree.query(query).distance_mm);
  }
}

TEST(ClosestPointTree, AnswersDoNotDependOnOrderOrSeed) {
  for (const auto& [name, model] : shapes::search_models()) {
    SCOPED_TRACE(name);
    const ClosestPointTree tree(model);
    const std::vector<Vec3> queries = shapes::search_queries(model, 1000, 14);
    const std::vector<ClosestPoint> closest = cold_answers(tree, queries);
    const std::vector<std::uint32_t> order = spatial_order(queries);
    std::vector<Vec3> sorted;
    for (const std::uint32_t i : order) sorted.push_back(queries[i]);
    const std::vector<ClosestPoint> in_order = cold_answers(tree, sorted);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::uint32_t i = order[k];
      EXPECT_TRUE(same_bits(in_order[k], closest[i]));
      EXPECT_TRUE(same_bits(tree.query(queries[i]), closest[i]));
      EXPECT_TRUE(same_bits(tree.query(queries[i], closest[i].facet), closest[i]));
      EXPECT_TRUE(
          same_bits(tree.query(queries[i], i % static_cast<std::uint32_t>(model.facet_count())), closest[i]));
    }
  }
}

// Motions as in a registration: large steps that shrink, then a jump, and again.
TEST(ClosestPointTree, TheCertifiedCacheIsNeverWrong) {
  for (const auto& [name, model] : shapes::search_models()) {
    SCOPED_TRACE(name);
    const ClosestPointTree tree(model);
    std::vector<Vec3> queries = shapes::search_queries(model, 800, 15);
    std::vector<CertifiedCache> cache(queries.size());
    std::vector<ClosestPoint> closest(queries.size());
    Rng rng(16, 0, "motions");
    for (int round = 0; round < 2; ++round) {
      for (double step = 3.0; step > 1e-7; step *= 0.2) {
        const RigidTransform motion{rotation_from_vector(0.02 * step * rng.normal_vector()),
                                    step * rng.normal_vector()};
        for (Vec3& query : queries) query = motion * query;
        ClosestPointWork work;
        tree.query(queries, closest, cache, work);
        EXPECT_EQ(work.queries, queries.size());
        const std::vector<ClosestPoint> cold = cold_answers(tree, queries);
        for (std::size_t i = 0; i < queries.size(); ++i)
          ASSERT_TRUE(same_bits(closest[i], cold[i])) << "query " << i << ", step " << step;
      }
      for (Vec3& query : queries) query += 20.0 * rng.normal_vector();
    }
  }
}

// Close to convergence the cache answers: points 0.01 mm from a sphere of facets of 1.5 mm that move by 1e-5
// mm lose their facet when their foot is within about 1e-3 mm of a facet's edge (0.3 % of the area), and may
// miss otherwise only where float cannot certify more.
TEST(ClosestPointTree, TheCertifiedCacheAnswersNearConvergence) {
  const FacetModel model = build_facet_model(shapes::sphere(40.0, 4), 0.0).model;
  const ClosestPointTree tree(model);
  Rng rng(17, 0, "points");
  std::vector<Vec3> queries(2000);
  for (Vec3& query : queries) query = 40.01 * rng.normal_vector().normalized();
  std::vector<CertifiedCache> cache(queries.size());
  std::vector<ClosestPoint> closest(queries.size());
  ClosestPointWork first, second;
  tree.query(queries, closest, cache, first);
  EXPECT_EQ(first.cache_hits, 0U);
  for (Vec3& query : queries) query += Vec3(1e-5, 0.0, 0.0);
  tree.query(queries, closest, cache, second);
  EXPECT_GT(second.cache_hits, 1900U);
  EXPECT_LT(second.facets_tested, first.facets_tested / 5);
}

TEST(ClosestPointTree, DoesNotDependOnThreads) {
  const FacetModel model =
      build_facet_model(shapes::torus(40.0, 10.0, 300, 100), 0.0).model;  // 60,000 facets
  const std::vector<Vec3> queries = shapes::search_queries(model, 2000, 18);
  const auto run = [&](int threads) {
    std::pair<std::vector<ClosestPoint>, ClosestPointWork> result;
    tbb::task_arena(threads).execute([&] {
      const ClosestPointTree tree(model);
      result.first.resize(queries.size());
      tree.query(queries, result.first, {}, result.second);
    });
    return result;
  };
  const auto [one, one_work] = run(1);
  const auto [four, four_work] = run(4);
  for (std::size_t i = 0; i < queries.size(); ++i) EXPECT_TRUE(same_bits(one[i], four[i]));
  // The same work to the last box: the same tree.
  EXPECT_EQ(one_work.boxes_tested, four_work.boxes_tested);
  EXPECT_EQ(one_work.facets_tested, four_work.facets_tested);
}

TEST(ClosestPointTree, DoesNotDependOnTheInstructionSet) {
  const FacetModel model = build_facet_model(shapes::torus(40.0, 10.0, 60, 24), 0.0).model;
  const std::vector<Vec3> queries = shapes::search_queries(model, 1000, 19);
  const ClosestPointTree tree(model);
  const std::vector<ClosestPoint> best = cold_answers(tree, queries);
  for (const std::int64_t target : {HWY_SCALAR, HWY_EMU128, HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
    hwy::SetSupportedTargetsForTest(0);
    if ((hwy::SupportedTargets() & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const std::vector<ClosestPoint> closest = cold_answers(tree, queries);
    for (std::size_t i = 0; i < queries.size(); ++i)
      EXPECT_TRUE(same_bits(closest[i], best[i])) << hwy::TargetName(target) << ", query " << i;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(ClosestPointTree, SearchesTheSelectedFacetsOnly) {
  for (const auto& [name, model] : shapes::search_models()) {
    SCOPED_TRACE(name);
    std::vector<std::uint32_t> selected;
    for (std::uint32_t facet = 0; facet < model.facet_count(); facet += 3) selected.push_back(facet);
    const ClosestPointTree tree(model, selected);
    for (const Vec3& query : shapes::search_queries(model, 100, 20)) {
      ClosestPoint truth;
      for (const std::uint32_t facet : selected) {
        const auto [a, b, c] = model.corners_mm(facet);
        const Vec3 point = closest_point_on_facet(a, b, c, query).point_mm;
        if ((query - point).norm() < truth.distance_mm) truth = {point, (query - point).norm(), facet, {}};
      }
      // A facet outside the selection as a seed is no seed.
      const ClosestPoint closest = tree.query(query, static_cast<std::uint32_t>(model.facet_count()) - 1);
      expect_is_closest(model, query, closest, truth);
      EXPECT_EQ(closest.facet % 3, 0U);
    }
  }
}

// Nor does it disturb the neighbours that are searched with it, whichever coordinate of whichever query it
// is.
TEST(ClosestPointTree, AQueryThatIsNotFiniteHasNoClosestPoint) {
  const FacetModel model = build_facet_model(shapes::sphere(40.0, 3), 0.0).model;
  const ClosestPointTree tree(model);
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) points.push_back(Vec3(40.0, 1.0, 0.01 * i));
  const std::vector<ClosestPoint> good = cold_answers(tree, points);
  for (const std::size_t bad : {0U, 3U, 20U, 39U})
    for (const double value : {std::nan(""), infinite, -infinite})
      for (int axes = 1; axes < 8; ++axes) {
        std::vector<Vec3> queries = points;
        for (int axis = 0; axis < 3; ++axis)
          if (axes >> axis & 1) queries[bad][axis] = value;
        std::vector<CertifiedCache> cache(queries.size());
        std::vector<ClosestPoint> closest(queries.size());
        ClosestPointWork work;
        for (int round = 0; round < 2; ++round) {
          tree.query(queries, closest, cache, work);
          for (std::size_t i = 0; i < queries.size(); ++i)
            EXPECT_TRUE(i == bad || same_bits(closest[i], good[i]));
          EXPECT_EQ(closest[bad].facet, kNoFacet);
          EXPECT_EQ(closest[bad].distance_mm, infinite);
        }
        EXPECT_EQ(tree.query(queries[bad]).facet, kNoFacet);
      }
}

TEST(ClosestPointTree, RefusesWrongSelections) {
  const FacetModel model = build_facet_model(shapes::cube(10.0), 0.0).model;
  const std::vector<std::uint32_t> none, outside{0, 12}, twice{3, 4, 3};
  EXPECT_THROW(ClosestPointTree(model, none), InputError);
  EXPECT_THROW(ClosestPointTree(model, outside), InputError);
  EXPECT_THROW(ClosestPointTree(model, twice), InputError);
  const ClosestPointTree tree(model);
  const std::vector<Vec3> queries(3, Vec3::Zero());
  std::vector<ClosestPoint> closest(2);
  ClosestPointWork work;
  EXPECT_THROW(tree.query(queries, closest, {}, work), InputError);
}

}  // namespace
}  // namespace trueblade
