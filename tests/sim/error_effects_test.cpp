// Each error source alone, through the whole virtual measurement, has the effect that its closed form says.
#include "tests/sim/error_effects.h"

#include <gtest/gtest.h>

namespace trueblade {
namespace {

std::string name_of_source(const ::testing::TestParamInfo<std::size_t>& number) {
  return std::string(info(static_cast<ErrorSource>(number.param)).name);
}

class ErrorEffect : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ErrorEffect, HasItsClosedForm) {
  const auto source = static_cast<ErrorSource>(GetParam());
  const double sigma = testing::usual_sigma(source);
  const testing::ErrorScene scene = testing::error_scene();

  // A mean without spread comes back in every point, up to second order. A turn of 10 urad moves things by up
  // to 3 um (arms below 300 mm), a shift by 1 um; on a plane that changes lever arms by as much, and normals
  // by 10 urad: below 1e-4 of an effect that is at least 0.1 per unit.
  const auto steady = testing::observed_values(scene, source, sigma, 0.0, 100);
  ASSERT_GT(steady.size(), 50u);
  for (const double value : steady) ASSERT_NEAR(value, sigma, 1e-3 * sigma) << info(source).name;

  // A spread has its standard deviation within 4 standard errors.
  const auto values = testing::observed_values(scene, source, 0.0, sigma, 2000);
  const auto n = static_cast<double>(values.size());
  ASSERT_GT(n, 1000.0);
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  EXPECT_NEAR(sum / n, 0.0, 4.0 * sigma / std::sqrt(n)) << info(source).name;
  EXPECT_NEAR(std::sqrt(sum_of_squares / n), sigma, 4.0 * sigma / std::sqrt(2.0 * n)) << info(source).name;
}

INSTANTIATE_TEST_SUITE_P(EverySource, ErrorEffect, ::testing::Range(std::size_t{0}, kErrorSourceCount),
                         name_of_source);

}  // namespace
}  // namespace trueblade
