// What a scenario promises of its own results: every scenario is a regression test.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/inspection_fields.h"
#include "apps/yaml_fields.h"
#include "inspection/result.h"

namespace trueblade {

// What is promised of one view. What is absent promises nothing.
struct ViewExpectation {
  std::map<std::string, std::pair<double, double>> range_of;  // of each quantity, by name
  std::string termination;                                    // of the registration, as in result.json
  std::string fails;  // words of the failure: the view is expected not to be registered at all
};

// The promised range of one number of the part as a whole.
struct PartExpectation {
  std::optional<std::pair<double, double>> value;
};

// Quantities are named as in result.json; see expectation.cpp for the list.
void fields(YamlFields& io, ViewExpectation& expectation);
void fields(YamlFields& io, PartExpectation& expectation);

struct Verdict {
  std::string view;  // "part" for the part as a whole
  std::string quantity;
  double low = 0.0, high = 0.0;
  double got = 0.0;  // NaN: the view or the quantity does not exist in the result
  bool holds = false;
  std::string expected_text, got_text;  // of a promise in words: then the numbers mean nothing
};

// The promise and what came of it, in words for tables.
std::string expected_words(const Verdict& verdict);
std::string got_words(const Verdict& verdict);

// A view that failed although nothing promises that is a broken promise too, once there is any promise of it.
std::vector<Verdict> judge(const std::map<std::string, ViewExpectation>& expected,
                           const std::vector<ViewResult>& views);

// The numbers of the part that an inspection block leads to are named
//   joint.rms_mm
//   profile.<name>.conforming            1 conforming, 0 not; absent: cannot tell
//   profile.<name>.profile_mm
//   section.<height>.<feature>           measured minus nominal, mm or rad
//   offset.<group>.translation_x_mm ...  and .rotation_x_rad ...
//   missing                              how many things that were asked for could not be made
//   missing_features                     how many features of measured sections have no number
std::vector<std::string> part_quantities(const InspectionSpec& inspection);
std::vector<Verdict> judge_part(const std::map<std::string, PartExpectation>& expected,
                                const EvaluationResult& evaluation);

}  // namespace trueblade
