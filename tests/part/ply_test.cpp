// PLY: the three encodings give the same values, every row is accounted for, errors say where, and a header
// cannot ask for more memory than the file is worth.
#include "part/ply.h"

#include <gtest/gtest.h>

#include <sstream>

#include "geometry/random.h"
#include "tests/part/expect_input_error.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

const std::string kHeader =
    "ply\nformat ascii 1.0\ncomment unit mm\nobj_info anything\nelement vertex 2\nproperty float x\n"
    "property int n\nelement face 2\nproperty list uchar int vertex_indices\nproperty short "
    "surface\nend_header\n";
const std::string kBody = "0.5 -7\n1.25e1 70000\n3 0 1 1 4\n0 -2\n";

std::string with_encoding(std::string header, const std::string& encoding) {
  return header.replace(header.find("ascii"), 5, encoding);
}

// The same rows by hand: 0.5f = 3f000000, 12.5f = 41480000, 70000 = 00011170.
const std::string kBigEndianBody{
    "\x3f\x00\x00\x00\xff\xff\xff\xf9"
    "\x41\x48\x00\x00\x00\x01\x11\x70"
    "\x03\x00\x00\x00\x00\x00\x00\x00\x01\x00\x00\x00\x01\x00\x04"
    "\x00\xff\xfe",
    34};
const std::string kLittleEndianBody{
    "\x00\x00\x00\x3f\xf9\xff\xff\xff"
    "\x00\x00\x48\x41\x70\x11\x01\x00"
    "\x03\x00\x00\x00\x00\x01\x00\x00\x00\x01\x00\x00\x00\x04\x00"
    "\x00\xfe\xff",
    34};

void expect_rows(const PlyFile& ply) {
  ASSERT_EQ(ply.elements.size(), 2U);
  EXPECT_EQ(ply.comments, std::vector<std::string>{"unit mm"});
  EXPECT_EQ(ply.find("vertex")->find("x")->values, (std::vector<double>{0.5, 12.5}));
  EXPECT_EQ(ply.find("vertex")->find("n")->values, (std::vector<double>{-7, 70000}));
  EXPECT_EQ(ply.find("face")->find("vertex_indices")->values, (std::vector<double>{0, 1, 1}));
  EXPECT_EQ(ply.find("face")->find("vertex_indices")->list_begin, (std::vector<std::uint32_t>{0, 3, 3}));
  EXPECT_EQ(ply.find("face")->find("surface")->values, (std::vector<double>{4, -2}));
}

TEST(Ply, TheThreeEncodingsGiveTheSameValues) {
  const TemporaryFolder folder;
  expect_rows(read_ply(folder.write("a.ply", kHeader + kBody)));
  expect_rows(read_ply(folder.write("b.ply", with_encoding(kHeader, "binary_big_endian") + kBigEndianBody)));
  expect_rows(
      read_ply(folder.write("l.ply", with_encoding(kHeader, "binary_little_endian") + kLittleEndianBody)));
}

TEST(Ply, LineEndsOfWindowsAndAMissingLastLineEndAreRead) {
  const TemporaryFolder folder;
  std::string windows;
  for (const char c : kHeader + kBody) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_rows(read_ply(folder.write("w.ply", windows)));
  expect_rows(read_ply(folder.write("e.ply", kHeader + kBody.substr(0, kBody.size() - 1))));
}

TEST(Ply, WhatIsWrittenIsReadBack) {
  const TemporaryFolder folder;
  const PlyFile ply = read_ply(folder.write("a.ply", kHeader + kBody));
  std::ostringstream stream;
  write_ply(stream, ply);
  expect_rows(read_ply(folder.write("w.ply", stream.str())));
}

TEST(Ply, ErrorsNameTheLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& bytes) { read_ply(folder.write("x.ply", bytes)); };
  EXPECT_INPUT_ERROR(read(kHeader + "0.5 -7\nabc 1\n3 0 1 1 4\n0 -2\n"), "x.ply:13: property x is \"abc\"");
  EXPECT_INPUT_ERROR(read(kHeader + "0.5 -7\n1 1.5\n3 0 1 1 4\n0 -2\n"), "x.ply:13: property n is \"1.5\"");
  EXPECT_INPUT_ERROR(read(kHeader + "0.5 -7\n1 3000000000\n3 0 1 1 4\n0 -2\n"), "does not fit its type");
  EXPECT_INPUT_ERROR(read(kHeader + "0.5 -7\n1 2 3\n3 0 1 1 4\n0 -2\n"), "x.ply:13: the row has more values");
  EXPECT_INPUT_ERROR(read(kHeader + "0.5 -7\n1 2\n3 0 1\n0 -2\n"), "x.ply:14: the row ends before");
  EXPECT_INPUT_ERROR(read(kHeader + "0.5 -7\n1 2\n3 0 1 1 4\n"), "has 1 of 2 rows");
  EXPECT_INPUT_ERROR(read(kHeader + kBody + "1 2\n"), "x.ply:16: data behind the last row");
  EXPECT_INPUT_ERROR(read("solid x\n"), "x.ply:1: is not a PLY file");
  EXPECT_INPUT_ERROR(read("ply\nformat ascii 2.0\n"), "x.ply:2:");
  EXPECT_INPUT_ERROR(read("ply\nformat ascii 1.0\nelement vertex -1\n"),
                     "x.ply:3: the count of element vertex");
  EXPECT_INPUT_ERROR(read("ply\nformat ascii 1.0\nproperty float x\n"), "x.ply:3: a property stands before");
  EXPECT_INPUT_ERROR(read("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n"),
                     "property type \"real\"");
  EXPECT_INPUT_ERROR(read("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n1\n"), "has no property");
}

TEST(Ply, AHeaderCannotAskForMoreThanTheFileHolds) {
  const TemporaryFolder folder;
  for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const char* count : {"1000000000000", "9223372036854775807"}) {
      std::string header = with_encoding(kHeader, encoding);
      header.replace(header.find("vertex 2"), 8, std::string("vertex ") + count);
      EXPECT_INPUT_ERROR(read_ply(folder.write("x.ply", header + kBody)), "do not fit into the file");
    }
}

TEST(Ply, EveryTruncationIsAnError) {
  const TemporaryFolder folder;
  const std::string binary = with_encoding(kHeader, "binary_little_endian") + kLittleEndianBody;
  for (std::size_t size = 1; size < binary.size(); ++size)
    EXPECT_THROW(read_ply(folder.write("x.ply", binary.substr(0, size))), InputError) << size;
  // In ascii the last row's last number may lose digits without anybody noticing.
  const std::string ascii = kHeader + kBody;
  for (std::size_t size = 1; size + 2 < ascii.size(); ++size)
    EXPECT_THROW(read_ply(folder.write("x.ply", ascii.substr(0, size))), InputError) << size;
}

TEST(Ply, DamagedBytesNeverDoMoreThanThrow) {
  const TemporaryFolder folder;
  for (const std::string& whole :
       {kHeader + kBody, with_encoding(kHeader, "binary_big_endian") + kBigEndianBody}) {
    for (std::uint64_t trial = 0; trial < 500; ++trial) {
      Rng random(1, trial, "damage");
      std::string bytes = whole;
      for (int change = 0; change < 3; ++change)
        bytes[random.bits() % bytes.size()] = static_cast<char>(random.bits() & 0xff);
      try {
        const PlyFile ply = read_ply(folder.write("x.ply", bytes));
        for (const PlyElement& element : ply.elements)
          for (const PlyProperty& property : element.properties)
            EXPECT_EQ(property.is_list ? property.list_begin.size() : property.values.size() + 1,
                      element.rows + 1);
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace trueblade
