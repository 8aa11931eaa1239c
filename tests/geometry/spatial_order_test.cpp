// Order along the Hilbert curve: a permutation; on a full grid every step is to a neighbouring cell, which no
// other order than a Hilbert-like curve does; the same for any number of threads.
#include "geometry/spatial_order.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "geometry/random.h"

namespace trueblade {
namespace {

TEST(SpatialOrder, IsAPermutation) {
  Rng rng(1, 0, "order");
  for (const std::size_t count : {0U, 1U, 2U, 1000U, 20000U}) {
    std::vector<Vec3> points(count);
    for (Vec3& point : points) point = 30.0 * rng.normal_vector();
    std::vector<std::uint32_t> order = spatial_order(points);
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0U);
    EXPECT_EQ(order, numbers);
  }
}

// A grid of 16^3 points in shuffled order: the curve goes from each to one of its six neighbours.
TEST(SpatialOrder, StepsFromCellToNeighbourCell) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < 16 * 16 * 16; ++i) {
    const std::uint32_t k = i * 1229 % 4096;  // odd factor: a permutation of 0 .. 4095
    points.push_back(Vec3(k % 16, k / 16 % 16, k / 256) - Vec3(3.0, 100.0, 8.0));
  }
  const std::vector<std::uint32_t> order = spatial_order(points);
  for (std::size_t i = 1; i < order.size(); ++i)
    ASSERT_EQ((points[order[i]] - points[order[i - 1]]).lpNorm<1>(), 1.0) << "step " << i;
}

TEST(SpatialOrder, KeepsTheOrderOfEqualPoints) {
  const std::vector<Vec3> points(100, Vec3(1.0, 2.0, 3.0));
  const std::vector<std::uint32_t> order = spatial_order(points);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(SpatialOrder, DoesNotDependOnThreads) {
  Rng rng(2, 0, "order");
  std::vector<Vec3> points(50000);
  for (Vec3& point : points) point = rng.normal_vector();
  std::vector<std::uint32_t> alone;
  tbb::task_arena(1).execute([&] { alone = spatial_order(points); });
  EXPECT_EQ(spatial_order(points), alone);
}

TEST(SpatialOrder, TakesAnyPoints) {
  const double infinite = std::numeric_limits<double>::infinity(), huge = std::numeric_limits<double>::max();
  const std::vector<Vec3> points{
      {huge, 0.0, 0.0}, {-huge, huge, -huge}, {std::nan(""), 0.0, 0.0}, {0.0, infinite, 0.0}};
  std::vector<std::uint32_t> order = spatial_order(points);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace trueblade
