// Covers: columns and values of the table, alignment, missing numbers, pose error only where truth is known.
#include "inspection/table.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/inspection/example_result.h"

namespace trueblade {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(InspectionTable, HasThePapersColumns) {
  const auto lines = lines_of(inspection_table(example_result()));
  ASSERT_EQ(lines.size(), 3U);
  for (const char* heading :
       {"Surfaces", "Points", "Time s", "RMS mm", "Min mm", "Max mm", "Pose error mm"}) {
    EXPECT_NE(lines[0].find(heading), std::string::npos) << heading;
  }
  for (const char* value :
       {"front", "102", "1500", "0.02", "0.0010", "-0.0040", "0.0041", "0.2220", "0.0001"}) {
    EXPECT_NE(lines[2].find(value), std::string::npos) << value;
  }
  // Every column ends where its heading ends.
  EXPECT_EQ(lines[2].find("0.0041") + 6, lines[0].find("Max mm") + 6);
  EXPECT_EQ(lines[0].size(), lines[2].size());
}

TEST(InspectionTable, ShowsADashForWhatIsNotThere) {
  InspectionResult result = example_result();
  result.views[0].truth.reset();
  result.views[0].statistics = {};
  const auto lines = lines_of(inspection_table(result));
  EXPECT_EQ(lines[0].find("Pose error"), std::string::npos);
  EXPECT_EQ(lines[2].find("nan"), std::string::npos);
  EXPECT_NE(lines[2].find(" -"), std::string::npos);
}

TEST(InspectionTable, OfNoViewIsTheHeading) {
  EXPECT_EQ(lines_of(inspection_table({})).size(), 2U);
}

}  // namespace
}  // namespace trueblade
