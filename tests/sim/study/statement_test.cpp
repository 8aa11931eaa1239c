// The statement and the stopping rule: closed forms, and the cases of JCGM 101:2008, clause 9, through the
// same engine that runs the studies.
#include "sim/study/statement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/random.h"
#include "sim/study/run_trials.h"
#include "sim/study/stopping_rule.h"

namespace trueblade {
namespace {

// Runs a model of one quantity through the engine, in one block of trials.
std::vector<double> values_of(const std::function<double(Rng)>& model, std::uint64_t seed, TrialRange range) {
  TrialQueue queue({range}, 1000);
  std::vector<double> values(range.size());
  run_trials([&] { return queue.next(); },
             [&](std::uint64_t trial) {
               return std::vector<Outcome>{{0, trial, "", {model(Rng(seed, trial, "model"))}}};
             },
             [&](const std::vector<Outcome>& outcomes) {
               for (const Outcome& outcome : outcomes)
                 values[outcome.trial - range.begin] = outcome.values[0];
             });
  return values;
}

struct AdaptiveRun {
  Statement statement;
  double tolerance;
};

AdaptiveRun run_adaptively(const std::function<double(Rng)>& model, double probability, int digits) {
  StoppingRule rule({probability, digits, std::nullopt});
  const std::size_t block = standard_block_size(probability);
  std::vector<double> all;
  while (!rule.is_stable()) {
    const auto values = values_of(model, 2008, {all.size(), all.size() + block});
    all.insert(all.end(), values.begin(), values.end());
    rule.add_block(values);
    if (rule.blocks() > 300) ADD_FAILURE() << "does not settle";
    if (rule.blocks() > 300) break;
  }
  return {statement_of(all, probability), rule.tolerance()};
}

double rectangular(Rng& rng, double low, double high) {
  return low + (high - low) * rng.uniform();
}

// Student's t with an integer number of degrees of freedom: normal over root mean chi-square.
double student(Rng& rng, int freedom) {
  const double normal = rng.normal();
  double squares = 0.0;
  for (int k = 0; k < freedom; ++k) {
    const double deviate = rng.normal();
    squares += deviate * deviate;
  }
  return normal / std::sqrt(squares / freedom);
}

TEST(Statement, OfKnownValues) {
  // 1 to 100 in any order: mean 50.5, variance 100 * 101 / 12.
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back((i * 37) % 100 + 1);
  const Statement s = statement_of(values, 0.9);
  EXPECT_EQ(s.trials, 100u);
  EXPECT_DOUBLE_EQ(s.mean, 50.5);
  EXPECT_NEAR(s.standard_uncertainty, std::sqrt(100.0 * 101.0 / 12.0), 1e-12);
  // q = 90, r = 5: from the 5th to the 95th value.
  EXPECT_EQ(s.symmetric.low, 5.0);
  EXPECT_EQ(s.symmetric.high, 95.0);
  EXPECT_EQ(s.shortest.high - s.shortest.low, 90.0);
}

TEST(Statement, ShortestIntervalOfASkewedDistribution) {
  // Quantiles of the exponential distribution: its density falls, so the shortest interval begins at 0 and
  // ends at -ln(1 - p).
  std::vector<double> values;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) values.push_back(-std::log1p(-(i + 0.5) / kCount));
  const Statement s = statement_of(values, 0.95);
  EXPECT_NEAR(s.shortest.low, 0.0, 2e-4);
  EXPECT_NEAR(s.shortest.high, -std::log(0.05), 2e-3);
  EXPECT_NEAR(s.symmetric.low, -std::log(0.975), 2e-4);
  EXPECT_NEAR(s.symmetric.high, -std::log(0.025), 4e-3);
}

TEST(Statement, LeastTrials) {
  for (const double probability : {0.5, 0.9, 0.95, 0.99}) {
    const std::size_t least = least_trials(probability);
    const Statement s = statement_of(std::vector<double>(least, 1.0), probability);
    EXPECT_EQ(s.symmetric.low, 1.0);
  }
  EXPECT_EQ(least_trials(0.95), 11u);  // q = 10: 0.95 * 10 + 0.5 would be all ten
}

TEST(Statement, NumericalToleranceAsInTheGuide) {
  // JCGM 101, 7.9.2: u = 0.00035 g with two digits: 35 * 10^-5, delta = 0.5 * 10^-5; one digit: 4 * 10^-4.
  EXPECT_NEAR(numerical_tolerance(0.00035, 2), 0.5e-5, 1e-18);
  EXPECT_NEAR(numerical_tolerance(0.00035, 1), 0.5e-4, 1e-18);
  EXPECT_NEAR(numerical_tolerance(2.0, 1), 0.5, 1e-15);   // example 2: u = 2 K
  EXPECT_NEAR(numerical_tolerance(9.96, 2), 0.5, 1e-15);  // 10 * 10^0
}

TEST(StoppingRule, KnowsTheScatterOfItsBlocks) {
  StoppingRule rule({0.9, 2, 1.0});
  std::vector<double> first, second;
  for (int i = 1; i <= 100; ++i) {
    first.push_back(i);
    second.push_back(i + 4.0);
  }
  rule.add_block(first);
  EXPECT_FALSE(rule.is_stable());
  rule.add_block(second);
  // Averages differ by 4: standard deviation of the mean 4 / sqrt(2) / sqrt(2) = 2, doubled 4.
  EXPECT_NEAR(rule.twice_standard_errors()[0], 4.0, 1e-12);
  EXPECT_NEAR(rule.twice_standard_errors()[1], 0.0, 1e-12);
  EXPECT_NEAR(rule.twice_standard_errors()[2], 4.0, 1e-12);
  EXPECT_FALSE(rule.is_stable());
  EXPECT_NEAR(rule.blocks_expected(), 32.0, 1e-9);  // 2 * (4 / 1)^2
}

TEST(StoppingRule, TakesTheUncertaintyOfAllValuesAsOneSample) {
  // Blocks of unequal size (trials that failed) and mean.
  StoppingRule rule({0.5, 2, std::nullopt});
  std::vector<double> all;
  for (const auto& [count, from] : {std::pair{40, 0.0}, std::pair{25, 7.0}, std::pair{33, -3.0}}) {
    std::vector<double> block;
    for (int i = 0; i < count; ++i) block.push_back(from + std::sqrt(i));
    all.insert(all.end(), block.begin(), block.end());
    rule.add_block(block);
  }
  const double expected = statement_of(all, 0.5).standard_uncertainty;
  EXPECT_NEAR(rule.standard_uncertainty(), expected, 1e-13 * expected);  // some hundred roundings
  EXPECT_EQ(rule.tolerance(), numerical_tolerance(expected, 2));
}

TEST(Jcgm101, FourNormals) {  // 9.2.2: u = 2.00, 95 % from -3.92 to 3.92
  const auto run = run_adaptively(
      [](Rng rng) { return rng.normal() + rng.normal() + rng.normal() + rng.normal(); }, 0.95, 2);
  EXPECT_NEAR(run.statement.mean, 0.0, run.tolerance);
  EXPECT_NEAR(run.statement.standard_uncertainty, 2.0, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.low, -3.92, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.high, 3.92, run.tolerance);
}

TEST(Jcgm101, FourRectangulars) {  // 9.2.3: u = 2.00, 95 % from -3.88 to 3.88
  const double half = std::sqrt(3.0);
  const auto model = [half](Rng rng) {
    return rectangular(rng, -half, half) + rectangular(rng, -half, half) + rectangular(rng, -half, half) +
           rectangular(rng, -half, half);
  };
  const auto run = run_adaptively(model, 0.95, 2);
  EXPECT_NEAR(run.statement.standard_uncertainty, 2.0, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.low, -3.88, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.high, 3.88, run.tolerance);
  // Closed form (Annex E): +-2 sqrt(3) (2 - (3/5)^(1/4)).
  EXPECT_NEAR(run.statement.symmetric.high, 2.0 * half * (2.0 - std::pow(0.6, 0.25)), run.tolerance);
}

// 9.2.4: three of standard deviation 1 and one of 10: u = 10.1, 95 % from -17.0 to 17.0, where a normal
// distribution of this u would reach 19.9.
TEST(Jcgm101, RectangularsOfDifferentWidths) {
  const double half = std::sqrt(3.0);
  const auto model = [half](Rng rng) {
    return rectangular(rng, -half, half) + rectangular(rng, -half, half) + rectangular(rng, -half, half) +
           rectangular(rng, -10.0 * half, 10.0 * half);
  };
  const auto run = run_adaptively(model, 0.95, 2);
  EXPECT_EQ(run.tolerance, 0.5);
  // Closed form: with S the sum of the narrow three and W the half width of the wide one, P(Y > y) is the
  // mean of max(0, S + W - y) over 2 W, a polynomial of the fourth degree (Irwin and Hall): 2.5 % at y
  // = 17.0158.
  EXPECT_NEAR(run.statement.standard_uncertainty, std::sqrt(103.0), run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.low, -17.0, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.high, 17.0, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.high, 17.0158, run.tolerance);
}

TEST(Jcgm101, MassCalibration) {  // 9.3: 1.2340 mg, u = 0.0754 mg, 95 % from 1.0834 to 1.3825 mg
  // Mass of a weight against a reference of 100 g, in air; delta m in mg from 100 g.
  const auto model = [](Rng rng) {
    const double reference_mg = 100000.0 + 0.050 * rng.normal();
    const double difference_mg = 1.234 + 0.020 * rng.normal();
    const double air = rectangular(rng, 1.10, 1.30);
    const double weight = rectangular(rng, 7000.0, 9000.0);
    const double reference = rectangular(rng, 7950.0, 8050.0);
    return (reference_mg + difference_mg) * (1.0 + (air - 1.2) * (1.0 / weight - 1.0 / reference)) - 100000.0;
  };
  const auto run = run_adaptively(model, 0.95, 1);
  EXPECT_NEAR(run.statement.mean, 1.2340, run.tolerance);
  EXPECT_NEAR(run.statement.standard_uncertainty, 0.0754, run.tolerance);
  EXPECT_NEAR(run.statement.shortest.low, 1.0834, run.tolerance);
  EXPECT_NEAR(run.statement.shortest.high, 1.3825, run.tolerance);
}

// Characteristic function of Student's t.
double student_cf(int freedom, double t) {
  const double half = 0.5 * freedom, x = std::sqrt(freedom) * t;
  return std::cyl_bessel_k(half, x) * std::pow(x, half) / (std::tgamma(half) * std::pow(2.0, half - 1.0));
}

// The gauge block again, without random numbers. To first order, and the second gives 3e-6 nm, its deviation
// is 838 nm plus a sum of independent terms, each symmetric about zero: the t distributed ones and the
// products -L da theta and -L as dtheta. This is the characteristic function of the sum.
double gauge_block_cf(double t) {
  constexpr double kLength_nm = 50.0e6;
  constexpr int kNodes =
      40;  // of the midpoint rule in each direction; with 20 the quantile moves by 0.005 nm
  double first = 0.0, second = 0.0;
  for (int i = 0; i < kNodes; ++i)
    for (int j = 0; j < kNodes; ++j) {
      const double u = (i + 0.5) / kNodes, v = (j + 0.5) / kNodes;
      // theta: normal about -0.1 and arc sine.
      const double x = t * kLength_nm * (0.9e-6 + 0.2e-6 * u) * v;
      first += std::cos(0.1 * x) * std::exp(-0.5 * 0.2 * 0.2 * x * x) * std::cyl_bessel_j(0.0, 0.5 * x);
      const double y = t * kLength_nm * (9.5e-6 + 4.0e-6 * u) * (0.025 + 0.05 * v);
      second += std::sin(y) / y;
    }
  return student_cf(18, 25.0 * t) * student_cf(24, 6.0 * t) * student_cf(5, 4.0 * t) *
         student_cf(8, 7.0 * t) * first * second / std::pow(kNodes, 4);
}

// Half of the interval that holds the probability, by inversion of the characteristic function (Gil-Pelaez
// 1951): F(x) = 1/2 + 1/pi int_0^inf sin(t x) cf(t) / t dt.
double gauge_block_reach_nm(double probability) {
  constexpr double kStep = 1e-3, kEnd = 0.3;  // per nm; there the function has fallen to 1e-12
  std::vector<double> weights;
  for (double t = 0.5 * kStep; t < kEnd; t += kStep)
    weights.push_back(kStep * gauge_block_cf(t) / (t * std::numbers::pi));
  double low = 0.0, high = 200.0;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    double share = 0.5;
    for (std::size_t n = 0; n < weights.size(); ++n)
      share += weights[n] * std::sin((static_cast<double>(n) + 0.5) * kStep * middle);
    (share < 0.5 + 0.5 * probability ? low : high) = middle;
  }
  return low;
}

TEST(Jcgm101, GaugeBlock) {  // 9.5: deviation from 50 mm: 838 nm, u = 36 nm, 99 % from 745 to 932 nm
  const auto model = [](Rng rng) {
    const double standard_nm = 50000623.0 + 25.0 * student(rng, 18);
    const double mean_difference_nm = 215.0 + 6.0 * student(rng, 24);
    const double random_nm = 4.0 * student(rng, 5);
    const double systematic_nm = 7.0 * student(rng, 8);
    const double expansion = rectangular(rng, 9.5e-6, 13.5e-6);
    const double temperature = -0.1 + 0.2 * rng.normal();
    const double cyclic = 0.5 * std::sin(2.0 * std::numbers::pi * rng.uniform());  // arc sine: U(-0.5, 0.5)
    // Curvilinear trapezoids: the half width is itself rectangular (6.4.3).
    const double half_expansion = rectangular(rng, 0.9e-6, 1.1e-6);
    const double expansion_difference = rectangular(rng, -half_expansion, half_expansion);
    const double half_temperature = rectangular(rng, 0.025, 0.075);
    const double temperature_difference = rectangular(rng, -half_temperature, half_temperature);
    const double theta = temperature + cyclic;
    // Eq. 37 of 9.5.2, exactly: (Ls (1 + as (theta - dtheta)) + d) / (1 + (as + da) theta).
    const double length_nm = (standard_nm * (1.0 + expansion * (theta - temperature_difference)) +
                              mean_difference_nm + random_nm + systematic_nm) /
                             (1.0 + (expansion + expansion_difference) * theta);
    return length_nm - 50.0e6;
  };
  const auto run = run_adaptively(model, 0.99, 2);
  EXPECT_NEAR(run.statement.mean, 838.0, run.tolerance);
  EXPECT_NEAR(run.statement.standard_uncertainty, 36.0, run.tolerance);
  // The Guide's ends come of its own trials, within the same tolerance, and are rounded to 1 nm: 745 is 0.65
  // nm from what it stands for.
  const double reach_nm = gauge_block_reach_nm(0.99);
  EXPECT_NEAR(reach_nm, 93.65, 0.005);
  EXPECT_NEAR(run.statement.symmetric.low, 838.0 - reach_nm, run.tolerance);
  EXPECT_NEAR(run.statement.symmetric.high, 838.0 + reach_nm, run.tolerance);
}

}  // namespace
}  // namespace trueblade
