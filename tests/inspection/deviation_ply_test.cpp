// Covers: the file byte by byte (header, sizes, every value of every vertex), outliers black, a scan without
// SNR, names with line breaks, an empty cloud, a folder that cannot be written.
#include "inspection/deviation_ply.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "geometry/error.h"
#include "tests/inspection/example_result.h"
#include "tests/inspection/fixtures.h"

namespace trueblade {
namespace {

Deviations three_points() {
  Deviations d;
  d.point_mm = {{1.0, 2.0, 3.0}, {-0.1, 1.0 / 3.0, 1e3}, {0.0, 0.0, 0.0}};
  d.nominal_mm = d.point_mm;
  d.normal.assign(3, Vec3::UnitZ());
  d.signed_mm = d.from_facets_mm = {-0.5, 0.25, 7.0};
  d.facet = {0, 1, 2};
  d.surface = {4, 101, 0};
  d.snr = {0.5, 1.0, 0.125};
  d.outliers.is_outlier = {false, false, true};
  return d;
}

template <class Value>
Value take(const std::string& bytes, std::size_t& at) {
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof(Value));
  at += sizeof(Value);
  return value;
}

TEST(DeviationPly, HoldsTheDeviationsOfAllViewsTogether) {
  const TemporaryFolder folder;
  Deviations all = three_points();
  all.signed_mm = {9.0, 0.125, 0.75, 0.5};  // the first point is another view's
  all.outliers.is_outlier = {false, false, true, false};
  write_deviation_ply(folder / "d.ply", three_points(), "front", example_result().run, {&all, 1});
  const std::string bytes = bytes_of(folder / "d.ply");
  const std::string end =
      "property uchar outlier\nproperty float scalar_deviation_together\nproperty uchar outlier_together\n"
      "end_header\n";
  std::size_t at = bytes.find(end);
  ASSERT_NE(at, std::string::npos);
  at += end.size();
  constexpr std::size_t kAlone = 3 * 8 + 2 * 4 + 3 + 4 + 1;
  ASSERT_EQ(bytes.size(), at + 3 * (kAlone + 4 + 1));
  const float deviations[] = {0.125F, 0.75F, 0.5F};
  for (int i = 0; i < 3; ++i) {
    at += kAlone;
    EXPECT_EQ(take<float>(bytes, at), deviations[i]);
    EXPECT_EQ(take<std::uint8_t>(bytes, at), i == 1);
  }
}

TEST(DeviationPly, ReadsBackByteByByte) {
  const TemporaryFolder folder;
  const Deviations d = three_points();
  const RunFacts run = example_result().run;
  write_deviation_ply(folder / "d.ply", d, "front", run);
  const std::string bytes = bytes_of(folder / "d.ply");

  const std::string header =
      "ply\n"
      "format binary_little_endian 1.0\n"
      "comment trueblade 1.2.3\n"
      "comment unit mm\n"
      "comment frame pcs\n"
      "comment view front\n"
      "comment scenario blade.yaml seed 18446744073709551615\n"
      "comment colours blue_green_red from -0.5 to 0.5 mm, outliers black\n"
      "element vertex 3\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property float scalar_deviation\nproperty float scalar_snr\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property int surface\nproperty uchar outlier\nend_header\n";
  ASSERT_EQ(bytes.substr(0, header.size()), header);
  ASSERT_EQ(bytes.size(), header.size() + 3 * (3 * 8 + 2 * 4 + 3 + 4 + 1));

  std::size_t at = header.size();
  const Colour colours[] = {{0, 0, 255}, colour_of(ColourMap::blue_green_red, 0.25, 0.5), kOutlierColour};
  for (std::size_t i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(take<double>(bytes, at), d.point_mm[i][axis]);
    EXPECT_EQ(take<float>(bytes, at), static_cast<float>(d.signed_mm[i]));
    EXPECT_EQ(take<float>(bytes, at), static_cast<float>(d.snr[i]));
    EXPECT_EQ(take<std::uint8_t>(bytes, at), colours[i].red);
    EXPECT_EQ(take<std::uint8_t>(bytes, at), colours[i].green);
    EXPECT_EQ(take<std::uint8_t>(bytes, at), colours[i].blue);
    EXPECT_EQ(take<std::int32_t>(bytes, at), static_cast<std::int32_t>(d.surface[i]));
    EXPECT_EQ(take<std::uint8_t>(bytes, at), d.outliers.is_outlier[i] ? 1 : 0);
  }
}

TEST(DeviationPly, ScanWithoutSnrAndNamesWithLineBreaks) {
  const TemporaryFolder folder;
  Deviations d = three_points();
  d.snr.clear();
  write_deviation_ply(folder / "d.ply", d, "a\nelement vertex 9", example_result().run);
  const std::string bytes = bytes_of(folder / "d.ply");
  EXPECT_EQ(bytes.find("\nelement vertex 9"), std::string::npos);
  std::size_t at = bytes.find("end_header\n") + 11 + 28;
  EXPECT_TRUE(std::isnan(take<float>(bytes, at)));
}

TEST(DeviationPly, OfNoPointIsAHeader) {
  const TemporaryFolder folder;
  write_deviation_ply(folder / "d.ply", {}, "front", example_result().run);
  const std::string bytes = bytes_of(folder / "d.ply");
  EXPECT_NE(bytes.find("element vertex 0\n"), std::string::npos);
  EXPECT_TRUE(bytes.ends_with("end_header\n"));
}

TEST(DeviationPly, UnwritableFolderIsBadInput) {
  EXPECT_THROW(write_deviation_ply("/proc/nowhere/d.ply", {}, "front", example_result().run), InputError);
}

}  // namespace
}  // namespace trueblade
