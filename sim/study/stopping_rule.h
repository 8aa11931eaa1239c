// The adaptive procedure of GUM Supplement 1 (JCGM 101:2008, 7.9): blocks of trials until mean, standard
// uncertainty and both ends of the coverage interval have stabilised. The blocks are fixed by their numbers,
// so that the decision does not depend on the order in which trials are finished.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "sim/study/statement.h"

namespace trueblade {

struct StoppingRuleOptions {
  double probability = 0.95;
  int significant_digits = 2;                // of the standard uncertainty that shall be right (7.9.2), or
  std::optional<double> absolute_tolerance;  // this number, in the unit of the quantity
};

// Block size of clause 7.9.4 b): max(100 / (1 - p), 10^4).
std::size_t standard_block_size(double probability);

class StoppingRule {
 public:
  explicit StoppingRule(const StoppingRuleOptions& options) : options_(options) {}

  void add_block(std::vector<double> values);

  std::size_t blocks() const { return blocks_.size(); }
  // Twice the standard deviations of the averages over the blocks of mean, uncertainty and the ends of the
  // symmetric interval (7.9.4 g to j). Precondition: two blocks.
  std::array<double, 4> twice_standard_errors() const;
  // The standard uncertainty of the values of all blocks as one sample (7.9.4 i). Precondition: a block.
  double standard_uncertainty() const;
  double tolerance() const;  // from it (7.9.4 j)
  bool is_stable() const;    // false before the second block
  // How many blocks the present scatter suggests in all; at least what there are.
  double blocks_expected() const;

 private:
  StoppingRuleOptions options_;
  std::vector<std::array<double, 4>> blocks_;  // mean, uncertainty, low end, high end
  std::vector<double> counts_;                 // values of each block
};

}  // namespace trueblade
