// Scan files: every bit of a view comes back; damaged files are refused, at every length.
#include "hardware/scan_file.h"
#include "tests/hardware/same_sample.h"

#include <gtest/gtest.h>

#include <fstream>

#include "geometry/error.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

class ScanFile : public ::testing::Test {
 protected:
  std::filesystem::path file_ =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("trueblade_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply");
  void TearDown() override { std::filesystem::remove(file_); }

  std::string content() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  void overwrite(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
  }
};

ViewScan some_scan() {
  Rng rng(3, 0, "scan");
  ViewScan scan;
  scan.view = "front, lower half";
  scan.theta_rad = 0.1 + 0.2;  // no short decimal
  scan.columns = 5;
  scan.rows = 4;
  scan.time_s = 1.0 / 3.0;
  scan.complete = true;
  for (std::uint32_t i = 0; i < 17; ++i) {
    ProbeSample s;
    s.axes = {rng.normal(), rng.normal(), rng.normal(), rng.normal()};
    s.distance_mm = rng.normal();
    s.snr = rng.uniform();
    s.time_s = i / 7.0;
    s.flags = ProbeFlags::from_bits(static_cast<std::uint8_t>(i % 8));
    if (s.flags.usable()) {
      scan.usable.push_back(i);
      scan.points.position_mcs_mm.push_back(rng.normal_vector());
      scan.points.snr.push_back(s.snr);
    }
    scan.samples.push_back(s);
    scan.grid_index.push_back(19 - i);
  }
  return scan;
}

TEST_F(ScanFile, EveryBitComesBack) {
  const ViewScan wrote = some_scan();
  write_scan(file_, wrote);
  const ViewScan read = read_scan(file_);
  EXPECT_EQ(read.view, wrote.view);
  EXPECT_EQ(read.theta_rad, wrote.theta_rad);
  EXPECT_EQ(read.columns, wrote.columns);
  EXPECT_EQ(read.rows, wrote.rows);
  EXPECT_EQ(read.time_s, wrote.time_s);
  EXPECT_EQ(read.complete, wrote.complete);
  EXPECT_EQ(read.grid_index, wrote.grid_index);
  EXPECT_EQ(read.usable, wrote.usable);
  EXPECT_EQ(read.points.position_mcs_mm, wrote.points.position_mcs_mm);
  EXPECT_EQ(read.points.snr, wrote.points.snr);
  ASSERT_EQ(read.samples.size(), wrote.samples.size());
  for (std::size_t i = 0; i < wrote.samples.size(); ++i) expect_same(read.samples[i], wrote.samples[i]);
  write_scan(file_, read);
  const std::string again = content();
  write_scan(file_, wrote);
  EXPECT_EQ(content(), again);
}

TEST_F(ScanFile, AnEmptyScanComesBack) {
  write_scan(file_, ViewScan{});
  EXPECT_TRUE(read_scan(file_).samples.empty());
}

TEST_F(ScanFile, TruncationIsSeenAtEveryLength) {
  write_scan(file_, some_scan());
  const std::string whole = content();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(read_scan_bytes(whole.substr(0, length), "cut.ply"), InputError) << "length " << length;
  }
  EXPECT_THROW(read_scan_bytes(whole + '\0', "long.ply"), InputError);
}

TEST_F(ScanFile, DamageAnywhereNeverCrashesAndNeverPassesInTheHeader) {
  write_scan(file_, some_scan());
  const std::string whole = content();
  const std::size_t header = whole.find("end_header\n") + 11;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x80);  // no header byte is valid with its high bit set
    const bool in_view_name = at >= whole.find("front") && at < whole.find("\ncomment theta_rad");
    if (at < header && !in_view_name) {
      EXPECT_THROW(read_scan_bytes(damaged, "damaged.ply"), InputError) << "byte " << at;
    } else {
      try {
        read_scan_bytes(damaged, "damaged.ply");
      } catch (const InputError&) {
      }
    }
  }
}

TEST_F(ScanFile, AClaimOfMoreSamplesThanTheFileHoldsIsRefusedWithoutAllocation) {
  write_scan(file_, some_scan());
  std::string whole = content();
  const std::string element = "element vertex ";
  const std::size_t at = whole.find(element) + element.size();
  whole.replace(at, whole.find('\n', at) - at, "18446744073709551615");
  overwrite(whole);
  EXPECT_THROW(read_scan(file_), InputError);
}

TEST_F(ScanFile, MissingFilesAndOtherPlyFilesAreRefused) {
  EXPECT_THROW(read_scan(file_), InputError);
  overwrite("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n");
  EXPECT_THROW(read_scan(file_), InputError);
}

TEST_F(ScanFile, AViewNameOfTwoLinesIsRefused) {
  ViewScan scan;
  scan.view = "a\nelement vertex 9";
  EXPECT_THROW(write_scan(file_, scan), InputError);
}

}  // namespace
}  // namespace trueblade
