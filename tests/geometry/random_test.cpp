// Keyed randomness: the generator's published answers, the deviate's published values, addressing, and
// moments and distribution with their standard errors. Seeds are fixed, so that a statistical bound once met
// is met for good; the bounds are such that a right generator with another seed would fail about once in the
// stated number of times.
#include "geometry/random.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace trueblade {
namespace {

// Random123 1.14, tests/kat_vectors, philox4x64 with 10 rounds: counter 0, key 0.
TEST(Rng, PhiloxGivesItsPublishedAnswer) {
  Rng rng(0, 0, 0);
  EXPECT_EQ(rng.bits(), 0x16554d9eca36314cu);
  EXPECT_EQ(rng.bits(), 0xdb20fe9d672d0fdcu);
  EXPECT_EQ(rng.bits(), 0xd7e772cee186176bu);
  EXPECT_EQ(rng.bits(), 0x7e68b68aec7ba23bu);
}

// Philox in its textbook form (Salmon et al. 2011, section 4.3), written out once more in 128-bit arithmetic.
std::array<std::uint64_t, 4> philox4x64_10(std::array<std::uint64_t, 4> counter,
                                           std::array<std::uint64_t, 2> key) {
  __extension__ using Wide = unsigned __int128;
  for (int round = 0; round < 10; ++round) {
    const Wide even = Wide{0xD2E7470EE14C6C93u} * counter[0], odd = Wide{0xCA5A826395121157u} * counter[2];
    counter = {static_cast<std::uint64_t>(odd >> 64) ^ counter[1] ^ key[0], static_cast<std::uint64_t>(odd),
               static_cast<std::uint64_t>(even >> 64) ^ counter[3] ^ key[1],
               static_cast<std::uint64_t>(even)};
    key[0] += 0x9E3779B97F4A7C15u;
    key[1] += 0xBB67AE8584CAA73Bu;
  }
  return counter;
}

TEST(Rng, TextbookFormGivesThePublishedAnswers) {
  constexpr std::uint64_t kOnes = ~std::uint64_t{0};
  EXPECT_EQ(philox4x64_10({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (std::array<std::uint64_t, 4>{0x87b092c3013fe90bu, 0x438c3c67be8d0224u, 0x9cc7d7c69cd777b6u,
                                          0xa09caebf594f0ba0u}));
  EXPECT_EQ(
      philox4x64_10({0x243f6a8885a308d3u, 0x13198a2e03707344u, 0xa4093822299f31d0u, 0x082efa98ec4e6c89u},
                    {0x452821e638d01377u, 0xbe5466cf34e90c6cu}),
      (std::array<std::uint64_t, 4>{0xa528f45403e61d95u, 0x38c72dbd566e9788u, 0xa5a1610e72fd18b5u,
                                    0x57bd43b5e52b7fe6u}));
}

TEST(Rng, KeyAndCounterLieWhereTheHeaderSays) {
  for (const std::uint64_t index :
       {std::uint64_t{0}, std::uint64_t{5}, std::uint64_t{1} << 40, ~std::uint64_t{0}})
    EXPECT_EQ(Rng(11, 22, 33).at(index).bits(), philox4x64_10({index / 4, 33, 0, 0}, {11, 22})[index % 4]);
}

TEST(Rng, NamedStreamsAreHashedByFnv1a) {
  // Published FNV-1a test values: "" and "foobar".
  EXPECT_EQ(Rng(1, 2, "").bits(), Rng(1, 2, std::uint64_t{0xcbf29ce484222325}).bits());
  EXPECT_EQ(Rng(1, 2, "foobar").bits(), Rng(1, 2, std::uint64_t{0x85944171f73967e8}).bits());
}

TEST(Rng, LeavesAndReturns) {
  Rng rng(1, 2, 3);
  std::vector<double> in_order;
  for (int i = 0; i < 50; ++i) in_order.push_back(rng.normal());
  for (int i = 49; i >= 0; --i) EXPECT_EQ(rng.at(static_cast<std::uint64_t>(i)).normal(), in_order[i]);
  Rng from_17 = Rng(1, 2, 3).at(17);
  for (int i = 17; i < 50; ++i) EXPECT_EQ(from_17.normal(), in_order[i]);
}

TEST(Rng, ABlockHoldsFourUniforms) {
  const Rng rng(1, 2, 3);
  constexpr std::size_t kCount = 5;
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{9}, std::uint64_t{1} << 50})
    for (const std::uint64_t stride : {1u, 16u}) {
      std::array<double, 4 * kCount> uniforms{};
      rng.uniforms_of_blocks(first, stride, kCount, uniforms);
      for (std::size_t k = 0; k < kCount; ++k)
        for (std::size_t word = 0; word < 4; ++word)
          EXPECT_EQ(uniforms[word * kCount + k], rng.at(4 * (first + k * stride) + word).uniform());
    }
}

TEST(Rng, AnotherSeedTrialOrStreamIsAnotherSequence) {
  const std::uint64_t first = Rng(1, 2, 3).bits();
  EXPECT_NE(Rng(2, 2, 3).bits(), first);
  EXPECT_NE(Rng(1, 3, 3).bits(), first);
  EXPECT_NE(Rng(1, 2, 4).bits(), first);
}

// Kolmogorov and Smirnov: sqrt(n) D exceeds 1.95 once in 1000 times, 2 exp(-2 * 1.95^2) = 0.001.
double ks_statistic(std::vector<double> uniforms) {
  std::sort(uniforms.begin(), uniforms.end());
  const auto n = static_cast<double>(uniforms.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < uniforms.size(); ++i)
    distance = std::max(
        {distance, uniforms[i] - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - uniforms[i]});
  return std::sqrt(n) * distance;
}

TEST(Rng, UniformIsUniform) {
  std::vector<double> along_index, along_trial, along_stream;
  Rng rng(7, 0, 0);
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    along_index.push_back(rng.uniform());
    along_trial.push_back(Rng(7, i, 0).uniform());
    along_stream.push_back(Rng(7, 0, i).uniform());
  }
  EXPECT_GT(*std::min_element(along_index.begin(), along_index.end()), 0.0);
  EXPECT_LT(*std::max_element(along_index.begin(), along_index.end()), 1.0);
  EXPECT_LT(ks_statistic(along_index), 1.95);
  EXPECT_LT(ks_statistic(along_trial), 1.95);
  EXPECT_LT(ks_statistic(along_stream), 1.95);
}

// Pairs of neighbouring draws on a 16 x 16 grid: chi-square with 255 degrees of freedom has mean 255 and
// standard deviation sqrt(510) = 22.6; above 330.5 once in 1000 times (255 + 3.09 * 22.6 plus the skew's
// correction).
TEST(Rng, NeighbouringDrawsAreIndependent) {
  constexpr int kPairs = 256 * 400;
  std::array<int, 256> cell{};
  Rng rng(8, 0, 0);
  for (int i = 0; i < kPairs; ++i) {
    const auto column = static_cast<int>(16.0 * rng.uniform());
    const auto row = static_cast<int>(16.0 * rng.uniform());
    ++cell[static_cast<std::size_t>(16 * row + column)];
  }
  double chi_square = 0.0;
  for (const int count : cell) chi_square += (count - 400.0) * (count - 400.0) / 400.0;
  EXPECT_LT(chi_square, 330.5);
}

TEST(Rng, NormalHasItsMoments) {
  constexpr int kDraws = 400'000;
  std::array<double, 5> sum{};
  std::vector<double> probabilities;
  Rng rng(9, 0, 0);
  for (int i = 0; i < kDraws; ++i) {
    const double z = rng.normal();
    probabilities.push_back(0.5 * std::erfc(-z / std::sqrt(2.0)));
    for (int power = 1; power <= 4; ++power) sum[static_cast<std::size_t>(power)] += std::pow(z, power);
  }
  // Var(z^k) = E z^2k - (E z^k)^2: 1, 2, 15 and 96. Four standard errors: outside once in 16,000 times.
  const double root = 4.0 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(sum[1] / kDraws, 0.0, root * 1.0);
  EXPECT_NEAR(sum[2] / kDraws, 1.0, root * std::sqrt(2.0));
  EXPECT_NEAR(sum[3] / kDraws, 0.0, root * std::sqrt(15.0));
  EXPECT_NEAR(sum[4] / kDraws, 3.0, root * std::sqrt(96.0));
  EXPECT_LT(ks_statistic(probabilities), 1.95);
}

TEST(Rng, NormalVectorTakesThreeDraws) {
  Rng rng(1, 2, 3), one_by_one(1, 2, 3);
  const Vec3 vector = rng.normal_vector();
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(vector[axis], one_by_one.normal());
}

TEST(InverseNormal, GivesThePublishedValues) {
  // Wichura (1988), section "Test data"; four ulps of each.
  EXPECT_DOUBLE_EQ(inverse_normal(0.25), -0.6744897501960817);
  EXPECT_DOUBLE_EQ(inverse_normal(0.001), -3.090232306167814);
  EXPECT_DOUBLE_EQ(inverse_normal(1e-20), -9.262340089798408);
  EXPECT_EQ(inverse_normal(0.5), 0.0);
}

// Against the C library's complementary error function: Phi(z(p)) = p. A relative error e of z changes Phi by
// z phi(z) e, relative to Phi at most (1 + z^2) e in the tail; to the claimed 1e-15 comes erfc's own few
// ulps, and the rounding of its argument, which the tail's slope amplifies by z^2 too.
TEST(InverseNormal, IsTheInverseEverywhere) {
  for (double p = 1e-300; p < 0.4; p *= 1.7) {
    const double z = inverse_normal(p);
    const double back = 0.5 * std::erfc(-z / std::sqrt(2.0));
    EXPECT_NEAR(back / p, 1.0, (1.0 + z * z) * 1.5e-15 + 1e-15) << p;
  }
  for (double p = 0.01; p < 1.0; p += 0.00127) {
    const double z = inverse_normal(p);
    EXPECT_NEAR(0.5 * std::erfc(-z / std::sqrt(2.0)), p, 2e-15) << p;
  }
}

TEST(InverseNormal, ManyAtOnceAreTheSameBitsOnEveryInstructionSet) {
  std::vector<double> p{0.5,     0.075,        0.925, std::nextafter(0.075, 0.0), std::nextafter(0.925, 1.0),
                        0x1p-53, 1.0 - 0x1p-53};
  for (double tail = 1e-300; tail < 0.1; tail *= 1e3) p.push_back(tail);
  Rng rng(3, 0, "many at once");
  while (p.size() < 1003) p.push_back(rng.uniform());
  for (const std::int64_t target : {HWY_SCALAR, HWY_EMU128, HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
    hwy::SetSupportedTargetsForTest(0);
    if ((hwy::SupportedTargets() & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{256}, p.size()}) {
      std::vector<double> z(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(count));
      inverse_normal(z);
      for (std::size_t i = 0; i < count; ++i)
        EXPECT_EQ(z[i], inverse_normal(p[i])) << hwy::TargetName(target) << " " << p[i];
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(InverseNormal, IsOddAndRising) {
  double last = -40.0;
  for (int i = 1; i < 1024; ++i) {
    const double p = i / 1024.0;  // 1 - p is exact
    const double z = inverse_normal(p);
    EXPECT_EQ(z, -inverse_normal(1.0 - p));
    EXPECT_GT(z, last);
    last = z;
  }
}

}  // namespace
}  // namespace trueblade
