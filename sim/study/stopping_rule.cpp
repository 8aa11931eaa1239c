#include "sim/study/stopping_rule.h"

#include <algorithm>
#include <cmath>

namespace trueblade {

std::size_t standard_block_size(double probability) {
  return std::max<std::size_t>(static_cast<std::size_t>(std::ceil(100.0 / (1.0 - probability))), 10000);
}

void StoppingRule::add_block(std::vector<double> values) {
  const Statement s = statement_of(std::move(values), options_.probability);
  blocks_.push_back({s.mean, s.standard_uncertainty, s.symmetric.low, s.symmetric.high});
  counts_.push_back(static_cast<double>(s.trials));
}

std::array<double, 4> StoppingRule::twice_standard_errors() const {
  const auto h = static_cast<double>(blocks_.size());
  std::array<double, 4> result{};
  for (std::size_t k = 0; k < 4; ++k) {
    double mean = 0.0, squares = 0.0;
    for (const auto& block : blocks_) mean += block[k] / h;
    for (const auto& block : blocks_) squares += (block[k] - mean) * (block[k] - mean);
    result[k] = 2.0 * std::sqrt(squares / (h * (h - 1.0)));
  }
  return result;
}

double StoppingRule::standard_uncertainty() const {
  // Squares about the common mean: those within the blocks, and those between their means.
  double count = 0.0, mean = 0.0, squares = 0.0;
  for (const double of_block : counts_) count += of_block;
  for (std::size_t k = 0; k < blocks_.size(); ++k) mean += counts_[k] / count * blocks_[k][0];
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const auto& [block_mean, uncertainty, low, high] = blocks_[k];
    squares += (counts_[k] - 1.0) * uncertainty * uncertainty +
               counts_[k] * (block_mean - mean) * (block_mean - mean);
  }
  return std::sqrt(squares / (count - 1.0));
}

double StoppingRule::tolerance() const {
  if (options_.absolute_tolerance) return *options_.absolute_tolerance;
  const double uncertainty = standard_uncertainty();
  // A quantity that never varies is known exactly.
  return uncertainty > 0.0 ? numerical_tolerance(uncertainty, options_.significant_digits) : 1.0;
}

bool StoppingRule::is_stable() const {
  if (blocks_.size() < 2) return false;
  const auto errors = twice_standard_errors();
  return *std::max_element(errors.begin(), errors.end()) < tolerance();
}

double StoppingRule::blocks_expected() const {
  const auto h = static_cast<double>(blocks_.size());
  if (blocks_.size() < 2) return h;
  const auto errors = twice_standard_errors();
  const double ratio = *std::max_element(errors.begin(), errors.end()) / tolerance();
  return std::max(h, std::ceil(h * ratio * ratio));
}

}  // namespace trueblade
