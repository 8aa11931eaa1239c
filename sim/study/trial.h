// The words of a Monte Carlo study. A trial is a pure function of its number: what it gives depends neither
// on the other trials nor on threads, ranks or order. Every trial is evaluated for all cases of the study, so
// that cases can be compared trial by trial (common random numbers).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace trueblade {

// One number that every trial gives.
struct Quantity {
  std::string name;  // with its unit, as in "front.rms_mm"
  std::string unit;  // "mm", "rad", "1"
  std::string description;
};

// What one trial gave in one case: one value for each quantity of the study, NaN where it does not exist.
struct Outcome {
  std::uint32_t case_number = 0;
  std::uint64_t trial = 0;
  std::string failure;  // why there is no result; empty: there is one
  std::vector<double> values;
};

struct TrialRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;  // not included
  std::uint64_t size() const { return end - begin; }
};

// The outcomes of one trial, in the order of the cases. Called from many threads at once.
using TrialFunction = std::function<std::vector<Outcome>(std::uint64_t trial)>;

}  // namespace trueblade
