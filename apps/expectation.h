// What a scenario promises of its own results: every scenario is a regression test.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/yaml_fields.h"
#include "inspection/result.h"

namespace trueblade {

// The promised range of each quantity of one view, by name. Absent quantities promise nothing.
struct ViewExpectation {
  std::map<std::string, std::pair<double, double>> range_of;
};

// Quantities are named as in result.json; see expectation.cpp for the list.
void fields(YamlFields& io, ViewExpectation& expectation);

struct Verdict {
  std::string view;
  std::string quantity;
  double low, high;
  double got;  // NaN: the view or the quantity does not exist in the result
  bool holds;
};

std::vector<Verdict> judge(const std::map<std::string, ViewExpectation>& expected,
                           const std::vector<ViewResult>& views);

}  // namespace trueblade
