// Fixed blocks and ordered sums: every element once, the same bits on any number of threads, exceptions come
// through.
#include "geometry/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <stdexcept>

#include "geometry/random.h"

namespace trueblade {
namespace {

TEST(Parallel, VisitsEveryElementOnceInFixedBlocks) {
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 1000u}) {
    std::vector<std::atomic<int>> visits(count);
    parallel_for_blocks(count, 64, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin % 64, 0u);
      EXPECT_EQ(end, std::min(count, begin + 64));
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& visit : visits) EXPECT_EQ(visit, 1);
  }
}

TEST(Parallel, OrderedSumHasTheSameBitsOnAnyNumberOfThreads) {
  // Numbers of sizes from 1e-8 to 1e8 and both signs: any other order of addition shows in the last digits.
  constexpr std::size_t kCount = 100'000;
  const auto term = [](std::size_t i) {
    Rng rng = Rng(1, 0, "sum").at(2 * i);
    return rng.normal() * std::pow(10.0, 16.0 * rng.uniform() - 8.0);
  };
  const auto partial = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += term(i);
    return sum;
  };
  double in_order = 0.0;
  for (std::size_t begin = 0; begin < kCount; begin += 100) in_order += partial(begin, begin + 100);
  for (const std::size_t threads : {1u, 2u, 8u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(ordered_sum(kCount, 100, 0.0, partial), in_order);
  }
}

TEST(Parallel, PassesExceptionsOn) {
  EXPECT_THROW(parallel_for_blocks(1000, 1,
                                   [](std::size_t begin, std::size_t) {
                                     if (begin == 500) throw std::runtime_error("block 500");
                                   }),
               std::runtime_error);
}

}  // namespace
}  // namespace trueblade
