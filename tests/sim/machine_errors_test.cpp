// Draws of the error sources: moments, independence of order and of the other sources, scopes, names.
#include "sim/machine_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "geometry/error.h"

namespace trueblade {
namespace {

constexpr std::uint64_t kDraws = 10'000;

TEST(MachineErrors, EverySourceHasItsMeanAndSigma) {
  MachineErrors errors;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s)
    errors[static_cast<ErrorSource>(s)] = {0.5 * static_cast<double>(s), 2.0, ErrorScope::point};
  std::array<double, kErrorSourceCount> sum{}, sum_of_squares{};
  ErrorValues values;
  for (std::uint64_t k = 0; k < kDraws; ++k) {
    draw_errors(errors, ErrorScope::point, 7, 0, k, values);
    for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
      const double centred = values[static_cast<ErrorSource>(s)] - 0.5 * static_cast<double>(s);
      sum[s] += centred;
      sum_of_squares[s] += centred * centred;
    }
  }
  // Standard errors: sigma / sqrt(n) of the mean, sigma / sqrt(2 n) of the deviation. 53 sources, two numbers
  // each: 4.5 standard errors are passed by one in 1400 such tests, and the seed is fixed.
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto& name = info(static_cast<ErrorSource>(s)).name;
    EXPECT_NEAR(sum[s] / kDraws, 0.0, 4.5 * 2.0 / std::sqrt(1.0 * kDraws)) << name;
    EXPECT_NEAR(std::sqrt(sum_of_squares[s] / kDraws), 2.0, 4.5 * 2.0 / std::sqrt(2.0 * kDraws)) << name;
  }
}

TEST(MachineErrors, ADrawDependsOnNoOtherSourceAndNoEarlierDraw) {
  MachineErrors alone;
  alone[ErrorSource::eyx] = {0.0, 1.0, ErrorScope::point};
  MachineErrors together = alone;
  together[ErrorSource::exx] = {0.0, 3.0, ErrorScope::point};
  together[ErrorSource::ecc] = {1.0, 3.0, ErrorScope::point};
  ErrorValues forward, backward;
  std::vector<double> drawn;
  for (std::uint64_t k = 0; k < 20; ++k) {
    draw_errors(alone, ErrorScope::point, 7, 3, k, forward);
    drawn.push_back(forward[ErrorSource::eyx]);
  }
  for (std::uint64_t k = 20; k-- > 0;) {
    draw_errors(together, ErrorScope::point, 7, 3, k, backward);
    EXPECT_EQ(backward[ErrorSource::eyx], drawn[k]);
  }
}

TEST(MachineErrors, ManyIndicesAtOnceDrawWhatEachDraws) {
  MachineErrors errors;
  std::vector<ErrorSource> sources;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    errors[source] = {0.1 * static_cast<double>(s), s % 5 == 0 ? 0.0 : 2.0, ErrorScope::point};
    errors[source].replicate = s % 7 == 0 ? 3 : 0;
    sources.push_back(source);
  }
  constexpr std::size_t kCount = 100;
  std::vector<double> together(sources.size() * kCount);
  draw_errors(errors, sources, error_stream(ErrorScope::point, 7, 3), 20, kCount, together);
  for (std::size_t k = 0; k < kCount; ++k) {
    ErrorValues alone;
    draw_errors(errors, ErrorScope::point, 7, 3, 20 + k, alone);
    for (std::size_t s = 0; s < sources.size(); ++s) EXPECT_EQ(together[s * kCount + k], alone[sources[s]]);
  }
}

// Where each draw lies in the stream is what recorded results depend on.
TEST(MachineErrors, ADrawIsTheSourcesPlaceInItsStream) {
  MachineErrors errors;
  errors[ErrorSource::ecc] = {0.5, 2.0, ErrorScope::point, 1};
  ErrorValues values;
  draw_errors(errors, ErrorScope::point, 7, 3, 20, values);
  const std::uint64_t place =
      (std::uint64_t{1} << 48) + 20 * 64 + static_cast<std::uint64_t>(ErrorSource::ecc);
  EXPECT_EQ(values[ErrorSource::ecc], 0.5 + 2.0 * Rng(7, 3, "errors per point").at(place).normal());
}

TEST(MachineErrors, SeedTrialScopeIndexAndSourceAllMatter) {
  MachineErrors errors;
  std::set<double> different;
  for (const ErrorScope scope : {ErrorScope::setup, ErrorScope::view, ErrorScope::line, ErrorScope::point})
    for (const std::uint64_t seed : {1u, 2u})
      for (const std::uint64_t trial : {0u, 1u})
        for (const std::uint64_t index : {0u, 1u})
          for (const ErrorSource source : {ErrorSource::exx, ErrorSource::eyx}) {
            errors[source] = {0.0, 1.0, scope};
            ErrorValues values;
            draw_errors(errors, scope, seed, trial, index, values);
            different.insert(values[source]);
          }
  EXPECT_EQ(different.size(), 64u);
}

TEST(MachineErrors, OnlyTheSourcesOfTheScopeAreDrawn) {
  MachineErrors errors;
  errors[ErrorSource::exx] = {5.0, 0.0, ErrorScope::view};
  errors[ErrorSource::ecc] = {6.0, 0.0, ErrorScope::line};
  ErrorValues values;
  draw_errors(errors, ErrorScope::line, 1, 0, 0, values);
  EXPECT_EQ(values[ErrorSource::exx], 0.0);
  EXPECT_EQ(values[ErrorSource::ecc], 6.0);
}

TEST(MachineErrors, NamesAreTheIsoNamesAndDiffer) {
  EXPECT_EQ(info(ErrorSource::eyx).name, "EYX");
  EXPECT_EQ(info(ErrorSource::c0y).name, "C0Y");
  EXPECT_EQ(info(ErrorSource::exc).name, "EXC");
  EXPECT_EQ(info(ErrorSource::xoc).name, "XOC");
  EXPECT_EQ(info(ErrorSource::drift_z).name, "drift_z");
  std::set<std::string_view> names;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) names.insert(info(static_cast<ErrorSource>(s)).name);
  EXPECT_EQ(names.size(), kErrorSourceCount);
}

TEST(MachineErrors, ImpossibleValuesAreRefusedByName) {
  MachineErrors negative;
  negative[ErrorSource::ezz].sigma = -1.0;
  try {
    negative.validate();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), "error source EZZ: sigma is -1, must be at least 0");
  }
  MachineErrors infinite;
  infinite[ErrorSource::aoc].mean = std::numeric_limits<double>::infinity();
  EXPECT_THROW(infinite.validate(), InputError);
}

}  // namespace
}  // namespace trueblade
