// Point files of other systems: what the columns mean, where the defects are, and LZF against data made by
// hand.
#include "part/read_points.h"

#include <gtest/gtest.h>

#include <bit>

#include "geometry/random.h"
#include "part/lzf.h"
#include "tests/part/expect_input_error.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

constexpr auto kMm = LengthUnit::millimetre;

TEST(ReadPointTable, SeparatorsHeadersAndComments) {
  const TemporaryFolder folder;
  const std::vector<Vec3> expected{{1, 2, 3}, {-4.5, 0.05, 6}};
  for (const char* text : {"1 2 3\n-4.5 5e-2 +6\n", "1,2,3\n-4.5, 0.05 ,6\n", "1;2;3\r\n-4.5;0.05;6\r\n",
                           "  1\t2\t3\n\n-4.5\t0.05\t6", "# a comment\n1 2 3\n// another\n-4.5 0.05 6\n",
                           "x,y,z\n1,2,3\n-4.5,0.05,6\n", "//X Y Z nx\n1 2 3 0\n-4.5 0.05 6 0\n",
                           "z;note;x;y\n3;a;1;2\n6;b;-4.5;0.05\n", "1 2 3 0 0 1\n-4.5 0.05 6 0 1 0\n"}) {
    const ScanPoints scan = read_points(folder.write("x.csv", text), kMm);
    EXPECT_EQ(scan.position_mcs_mm, expected) << text;
    EXPECT_TRUE(scan.snr.empty()) << text;
  }
}

TEST(ReadPointTable, SnrIsTheFourthColumnOrTheOneOfThatName) {
  const TemporaryFolder folder;
  for (const char* text : {"1 2 3 0.5\n4 5 6 1\n", "SNR x y z\n0.5 1 2 3\n1 4 5 6\n",
                           "x,y,z,a,Scalar_SNR\n1,2,3,9,0.5\n4,5,6,9,1\n"})
    EXPECT_EQ(read_points(folder.write("x.xyz", text), kMm).snr, (std::vector<double>{0.5, 1.0})) << text;
}

TEST(ReadPointTable, UnitIsGivenOrStated) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_points(folder.write("a.asc", "# unit in\n1 2 3\n"), std::nullopt).position_mcs_mm[0],
            Vec3(25.4, 50.8, 25.4 * 3));
  EXPECT_EQ(read_points(folder.write("b.asc", "1 2 3\n"), LengthUnit::metre).position_mcs_mm[0],
            Vec3(1000, 2000, 3000));
  EXPECT_INPUT_ERROR(read_points(folder.write("c.asc", "1 2 3\n"), std::nullopt), "unit is missing");
  EXPECT_INPUT_ERROR(read_points(folder.write("d.asc", "# unit in\n1 2 3\n"), kMm),
                     "not the one that the file states");
}

TEST(ReadPointTable, ErrorsNameTheLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) { read_points(folder.write("x.txt", text), kMm); };
  EXPECT_INPUT_ERROR(read("1 2 3\n1 2\n"), "x.txt:2: must hold x y z");
  EXPECT_INPUT_ERROR(read("1 2 3\n1 2 3 4\n"), "x.txt:2: has 4 columns, must have 3");
  EXPECT_INPUT_ERROR(read("1 2 3\n1 b 3\n"), "x.txt:2: y is \"b\"");
  EXPECT_INPUT_ERROR(read("1 2 nan\n"), "x.txt:1: a coordinate is not finite");
  EXPECT_INPUT_ERROR(read("1 2 3 1.5\n"), "x.txt:1: SNR is 1.5");
  EXPECT_INPUT_ERROR(read("1 2 3 nan\n"), "x.txt:1: SNR is nan");
  EXPECT_INPUT_ERROR(read("a b c\n"), "x.txt:1: must be three numbers or a header");
  EXPECT_INPUT_ERROR(read("# only a comment\n"), "has no points");
  // A decimal comma must not become two columns.
  EXPECT_INPUT_ERROR(read("1,5;2,3;3,1\n"), "x.txt:1:");
  EXPECT_INPUT_ERROR(read("1,5 2,3 3,1\n"), "x.txt:1:");
  EXPECT_INPUT_ERROR(read_points(folder.write("x.las", "1"), kMm), "is no point format");
}

const std::string kPcd =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y snr z\nSIZE 4 4 8 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT "
    "1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

std::string bits(float value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(std::bit_cast<std::uint32_t>(value) >> shift & 0xff);
  return bytes;
}
std::string bits(double value) {
  std::string bytes;
  for (int shift = 0; shift < 64; shift += 8)
    bytes += static_cast<char>(std::bit_cast<std::uint64_t>(value) >> shift & 0xff);
  return bytes;
}
std::string size_bytes(std::size_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

const std::string kRows =
    bits(1.f) + bits(2.f) + bits(0.25) + bits(3.f) + bits(4.f) + bits(5.f) + bits(1.0) + bits(6.f);
const std::string kColumns =
    bits(1.f) + bits(4.f) + bits(2.f) + bits(5.f) + bits(0.25) + bits(1.0) + bits(3.f) + bits(6.f);

// LZF that only copies: runs of at most 32 bytes.
std::string lzf_literals(const std::string& bytes) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    out += static_cast<char>(run.size() - 1) + run;
  }
  return out;
}

TEST(ReadPcd, TheThreeEncodingsGiveTheSamePoints) {
  const TemporaryFolder folder;
  const std::string compressed = lzf_literals(kColumns);
  for (const std::string& data :
       {std::string("ascii\n1 2 0.25 3\n4 5 1 6\n"), "binary\n" + kRows,
        "binary_compressed\n" + size_bytes(compressed.size()) + size_bytes(kColumns.size()) + compressed}) {
    const ScanPoints scan = read_points(folder.write("x.pcd", kPcd + data), kMm);
    EXPECT_EQ(scan.position_mcs_mm, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
    EXPECT_EQ(scan.snr, (std::vector<double>{0.25, 1.0}));
  }
}

TEST(ReadPcd, NanIsAMissingCellOfAGridAndAnErrorElsewhere) {
  const TemporaryFolder folder;
  const std::string header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  const std::string data = "DATA ascii\n1 2 3\nnan nan nan\n";
  EXPECT_EQ(read_points(folder.write("g.pcd", header + "WIDTH 1\nHEIGHT 2\nPOINTS 2\n" + data), kMm).size(),
            1U);
  EXPECT_INPUT_ERROR(read_points(folder.write("c.pcd", header + "WIDTH 2\nHEIGHT 1\nPOINTS 2\n" + data), kMm),
                     "c.pcd:9: a coordinate is not finite");
}

TEST(ReadPcd, BadFilesSayWhy) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) { read_points(folder.write("x.pcd", text), kMm); };
  EXPECT_INPUT_ERROR(read(kPcd + "ascii\n1 2 0.25 3\n"), "1 of 2 points are there");
  EXPECT_INPUT_ERROR(read(kPcd + "ascii\n1 2 0.25\n4 5 1 6\n"), "x.pcd:12: has 3 values, must have 4");
  EXPECT_INPUT_ERROR(read(kPcd + "binary\n" + kRows.substr(0, 30)), "is truncated");
  EXPECT_INPUT_ERROR(read(kPcd + "binary_compressed\n" + size_bytes(3) + size_bytes(7) + "abc"),
                     "another size than");
  EXPECT_INPUT_ERROR(read(kPcd + "zip\n"), "x.pcd:11: DATA is \"zip\"");
  EXPECT_INPUT_ERROR(read("FIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n"), "has no single z");
  EXPECT_INPUT_ERROR(read("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
                     "which is no number");
  std::string many = kPcd;
  many.replace(many.find("WIDTH 2"), 7, "WIDTH 4000000000")
      .replace(many.find("POINTS 2"), 8, "POINTS 4000000000");
  EXPECT_INPUT_ERROR(read(many + "binary\n" + kRows), "is truncated");
  EXPECT_INPUT_ERROR(read(many + "binary_compressed\n" + size_bytes(3) + size_bytes(7) + "abc"),
                     "is truncated");
}

TEST(Lzf, BackReferencesMayOverlapThemselves) {
  // "ab", then 7 bytes from 2 back (length bits 5: 5 + 2), then 10 from 1 back (7, another byte 1: 7 + 1 +
  // 2).
  const std::string data{
      "\x01"
      "ab"
      "\xa0\x01"
      "\xe0\x01\x00",
      8};
  EXPECT_EQ(lzf_decompressed(data, 19),
            "ab"
            "abababa"
            "aaaaaaaaaa");
  EXPECT_EQ(lzf_decompressed(data, 18), std::nullopt);
  EXPECT_EQ(lzf_decompressed(data, 20), std::nullopt);
  EXPECT_EQ(lzf_decompressed(std::string("\xa0\x01", 2), 7), std::nullopt);  // back beyond the beginning
  EXPECT_EQ(lzf_decompressed("\x01", 1000000000), std::nullopt);             // no data expand that far
}

TEST(Lzf, DamagedDataNeverDoMoreThanFail) {
  for (std::uint64_t trial = 0; trial < 5000; ++trial) {
    Rng random(2, trial, "lzf");
    std::string data;
    for (int i = 0; i < 40; ++i) data += static_cast<char>(random.bits() & 0xff);
    if (const auto out = lzf_decompressed(data, 100)) {
      EXPECT_EQ(out->size(), 100U);
    }
  }
}

TEST(ReadPlyPoints, UnitCommentSnrAndDefects) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\ncomment unit mm\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty float snr\nend_header\n1 2 3 0.5\n";
  const auto read = [&](const std::string& rest) {
    return read_points(folder.write("x.ply", header + rest), std::nullopt);
  };
  EXPECT_EQ(read("4 5 6 1\n").snr, (std::vector<double>{0.5, 1.0}));
  EXPECT_INPUT_ERROR(read("4 5 6 1.01\n"), "x.ply:11: SNR is 1.01");
  EXPECT_INPUT_ERROR(read("4 inf 6 1\n"), "x.ply:11: a coordinate is not finite");
}

TEST(ReadPlyPoints, RawRangeViewsOfTheBunny) {
  const std::filesystem::path folder = std::filesystem::path(TRUEBLADE_DATA_DIR) / "bunny";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  // Counts of the headers.
  EXPECT_EQ(read_points(folder / "bun000.ply", LengthUnit::metre).size(), 40256U);
  EXPECT_EQ(read_points(folder / "bun045.ply", LengthUnit::metre).size(), 40097U);
}

}  // namespace
}  // namespace trueblade
