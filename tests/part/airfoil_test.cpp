// Sections: the published 65-series ordinates, real .dat files, and files that are none.
#include "part/airfoil.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "geometry/error.h"

namespace trueblade {
namespace {

namespace fs = std::filesystem;

fs::path airfoil_folder() {
  return fs::path(TRUEBLADE_DATA_DIR) / "airfoils";
}

class AirfoilFile : public testing::Test {
 protected:
  void SetUp() override {
    file_ = fs::temp_directory_path() / ("trueblade_airfoil_test_" + std::to_string(::getpid()) + ".dat");
  }
  void TearDown() override { fs::remove(file_); }

  // A diamond-like outline with six points per side, in Selig's order.
  static std::vector<std::string> good_lines() {
    return {"a section", "1.0 0.0",   "0.8 0.02",  "0.6 0.04",  "0.4 0.05",  "0.2 0.04", "0.0 0.0",
            "0.2 -0.03", "0.4 -0.04", "0.6 -0.03", "0.8 -0.02", "0.9 -0.01", "1.0 0.0"};
  }
  AirfoilSection read(const std::vector<std::string>& lines) {
    std::ofstream stream(file_);
    for (const std::string& line : lines) stream << line << '\n';
    stream.close();
    return read_airfoil(file_);
  }
  std::string error_of(const std::vector<std::string>& lines) {
    try {
      read(lines);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  fs::path file_;
};

#define EXPECT_MENTIONS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

TEST_F(AirfoilFile, ReadsTitleAndPoints) {
  const AirfoilSection section = read(good_lines());
  EXPECT_EQ(section.name, "a section");
  ASSERT_EQ(section.outline.size(), 12u);
  EXPECT_EQ(section.outline[1], Vec2(0.8, 0.02));
}

TEST_F(AirfoilFile, ReadsAFileWithoutTitle) {
  auto lines = good_lines();
  lines.erase(lines.begin());
  const AirfoilSection section = read(lines);
  EXPECT_EQ(section.name, file_.stem().string());
  EXPECT_EQ(section.outline.size(), 12u);
}

TEST_F(AirfoilFile, NamesTheLineThatIsWrong) {
  const auto with = [](std::size_t line, const std::string& text) {
    auto lines = good_lines();
    lines[line - 1] = text;
    return lines;
  };
  EXPECT_MENTIONS(error_of(with(4, "0.6 nan")), ":4: \"nan\" is not finite");
  EXPECT_MENTIONS(error_of(with(4, "inf 0.1")), ":4: \"inf\" is not finite");
  EXPECT_MENTIONS(error_of(with(4, "0.6 abc")), ":4: \"abc\" is not a number");
  EXPECT_MENTIONS(error_of(with(4, "0.6 0.1 0.2")), ":4: has 3 fields");
  EXPECT_MENTIONS(error_of(with(4, "0.6")), ":4: has 1 fields");
  EXPECT_MENTIONS(error_of(with(4, "0.9 0.04")), ":4: the outline must run");
  EXPECT_MENTIONS(error_of(with(4, "0.6 0.7")), ":4: the point lies outside");
  EXPECT_MENTIONS(error_of(with(5, "0.4 -0.06")), ":5: the upper side");
  EXPECT_MENTIONS(error_of(with(13, "0.95 0.0")), ":13: the last point");
}

TEST_F(AirfoilFile, RefusesOtherFormats) {
  // Lednicer: the second line holds the numbers of points.
  EXPECT_MENTIONS(error_of({"a section", "26. 26.", "0.0 0.0", "0.1 0.05"}), ":2:");
  EXPECT_MENTIONS(error_of({"a section"}), "0 points");
  EXPECT_MENTIONS(error_of({"a section", "1 0", "0.5 0.1", "0 0", "0.5 -0.1", "1 0"}), "5 points");
  EXPECT_MENTIONS(error_of({}), file_.string());
  fs::remove(file_);
  EXPECT_THROW(read_airfoil(file_), InputError);
  EXPECT_THROW(read_airfoil(fs::temp_directory_path()), InputError);
}

TEST_F(AirfoilFile, RefusesAnOutlineThatRunsTheOtherWay) {
  auto lines = good_lines();
  std::reverse(lines.begin() + 1, lines.end());
  EXPECT_MENTIONS(error_of(lines), "the upper side, which comes first");
}

// The files print NACA's ordinates, which were computed by hand from tables with five decimals: half a unit
// of the print, half a unit of the thickness and 0.4 times half a unit of the mean line, 1.2e-5 together.
class Naca65Ordinates : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(Naca65Ordinates, AgreeWithPublishedFiles) {
  const auto [name, lift_coefficient] = GetParam();
  if (!fs::exists(airfoil_folder() / name)) GTEST_SKIP() << "no real sections in " << airfoil_folder();
  const AirfoilSection published = read_airfoil(airfoil_folder() / name);
  const AirfoilSection ours = naca_65_section(lift_coefficient);
  ASSERT_EQ(published.outline.size(), ours.outline.size());
  for (std::size_t i = 0; i < ours.outline.size(); ++i) {
    EXPECT_NEAR(ours.outline[i].x(), published.outline[i].x(), 1.25e-5) << "point " << i;
    EXPECT_NEAR(ours.outline[i].y(), published.outline[i].y(), 1.25e-5) << "point " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(TenPercent, Naca65Ordinates,
                         testing::Values(std::pair{"naca65210.dat", 0.2}, std::pair{"naca65410.dat", 0.4}),
                         [](const auto& each) { return fs::path(each.param.first).stem().string(); });

TEST(Airfoil, ReadsEveryRealSection) {
  if (!fs::exists(airfoil_folder())) GTEST_SKIP() << "no real sections in " << airfoil_folder();
  for (const auto& entry : fs::directory_iterator(airfoil_folder())) {
    const AirfoilSection section = read_airfoil(entry.path());
    EXPECT_GE(section.outline.size(), 51u) << entry.path();
    EXPECT_NEAR(section.outline.front().x(), 1.0, 1e-12) << entry.path();
  }
}

}  // namespace
}  // namespace trueblade
