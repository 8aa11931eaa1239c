// Results of `trueblade regress`, and their JUnit XML, which build servers read.
#pragma once

#include <string>
#include <vector>

#include "apps/expectation.h"

namespace trueblade {

struct RegressionCase {
  std::string scenario;
  std::vector<Verdict> verdicts;
  std::string error;  // the scenario did not run; empty when it did
  double time_s = 0.0;

  bool passed() const;
};

// One test case for each promise of each scenario.
std::string junit_xml(const std::vector<RegressionCase>& cases);

}  // namespace trueblade
