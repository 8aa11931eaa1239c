// The requests that trueblade-hal takes from the network: whole, in pieces, and what is no request.
#include "hardware/linuxcnc/driver_request.h"

#include <gtest/gtest.h>

#include <vector>

#include "hardware/bytes.h"

namespace trueblade {
namespace {

using Kind = DriverRequest::Kind;

const std::string kProgram("G21 G90\nhold\n\0M2\n", 17);  // what looks like a request in it is none

std::string announced(std::size_t bytes, std::uint32_t checksum) {
  return "program " + std::to_string(bytes) + " " + std::to_string(checksum) + "\n";
}

std::string sent(const std::string& program) {
  return announced(program.size(), crc32_of(program)) + program;
}

std::vector<DriverRequest> requests_of(DriverRequestReader& reader) {
  std::vector<DriverRequest> requests;
  while (auto request = reader.next()) requests.push_back(std::move(*request));
  return requests;
}

// That the first of the two pieces, then both together, bring the one request and nothing else, wherever the
// cut is.
void expect_in_two_pieces(const std::string& bytes, Kind kind, const std::string& program) {
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    DriverRequestReader reader;
    reader.feed(bytes.substr(0, cut));
    EXPECT_FALSE(reader.next()) << bytes << " cut at " << cut;
    reader.feed(bytes.substr(cut));
    const auto requests = requests_of(reader);
    ASSERT_EQ(requests.size(), 1u) << bytes << " cut at " << cut;
    EXPECT_EQ(requests[0].kind, kind);
    EXPECT_EQ(requests[0].program, program);
    EXPECT_EQ(reader.fault(), "");
  }
}

TEST(DriverRequest, EveryRequestCutAnywhere) {
  expect_in_two_pieces("samples\n", Kind::samples, "");
  expect_in_two_pieces("quiet\n", Kind::quiet, "");
  expect_in_two_pieces("watch\n", Kind::watch, "");
  expect_in_two_pieces("alive\n", Kind::alive, "");
  expect_in_two_pieces("release\n", Kind::release, "");
  expect_in_two_pieces("hold\n", Kind::hold, "");
  expect_in_two_pieces(sent(kProgram), Kind::program, kProgram);
  expect_in_two_pieces(sent(""), Kind::program, "");
}

TEST(DriverRequest, ASessionInPiecesOfAnySize) {
  const std::string session = "watch\nalive\n" + sent(kProgram) + "samples\n" + sent("M2\n") + "release\n";
  for (std::size_t piece = 1; piece <= session.size(); ++piece) {
    DriverRequestReader reader;
    std::vector<Kind> kinds;
    std::string programs;
    for (std::size_t at = 0; at < session.size(); at += piece) {
      reader.feed(session.substr(at, piece));
      for (const DriverRequest& request : requests_of(reader)) {
        kinds.push_back(request.kind);
        programs += request.program;
      }
    }
    EXPECT_EQ(kinds, (std::vector<Kind>{Kind::watch, Kind::alive, Kind::program, Kind::samples, Kind::program,
                                        Kind::release}));
    EXPECT_EQ(programs, kProgram + "M2\n");
  }
}

// One request that is good, then the bytes, in two pieces cut anywhere: the same fault, and nothing after it.
void expect_fault(const std::string& bytes, const std::string& fault) {
  const std::size_t step = 1 + bytes.size() / 64;
  for (std::size_t cut = 0; cut <= bytes.size(); cut += step) {
    DriverRequestReader reader;
    reader.feed("alive\n" + bytes.substr(0, cut));
    std::vector<DriverRequest> requests = requests_of(reader);
    reader.feed(bytes.substr(cut));
    for (auto& request : requests_of(reader)) requests.push_back(std::move(request));
    ASSERT_EQ(requests.size(), 1u) << bytes.substr(0, 80) << " cut at " << cut;
    EXPECT_EQ(reader.fault(), fault) << bytes.substr(0, 80) << " cut at " << cut;
    reader.feed("hold\n");
    EXPECT_FALSE(reader.next());
  }
}

TEST(DriverRequest, WhatIsNoRequestEndsTheReading) {
  for (const std::string line : {"",
                                 "hold ",
                                 " hold",
                                 "HOLD",
                                 "hold\r",
                                 "hold now",
                                 "program",
                                 "program ",
                                 "program 5",
                                 "program 5 ",
                                 "program x 0",
                                 "program 5 x",
                                 "program 5 0 0",
                                 "program  5 0",
                                 "program -5 0",
                                 "program +5 0",
                                 "program 5 -1",
                                 "program 0x5 0",
                                 "program 5 4294967296",
                                 "program 18446744073709551616 0"})
    expect_fault(line + "\nhold\n", "a line is no request");
  expect_fault(std::string("hold\0\nhold\n", 11), "a line is no request");
  expect_fault("\xff\xfe\x80\nhold\n", "a line is no request");
}

TEST(DriverRequest, GarbageAfterAProgram) {
  DriverRequestReader reader;
  reader.feed(sent(kProgram) + "M2\n");
  EXPECT_EQ(reader.next().value().program, kProgram);
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.fault(), "a line is no request");
}

TEST(DriverRequest, AWrongChecksum) {
  expect_fault(announced(kProgram.size(), crc32_of(kProgram) ^ 1u) + kProgram + "hold\n",
               "the checksum of a program is wrong");
  expect_fault(announced(kProgram.size() - 1, crc32_of(kProgram)) + kProgram + "hold\n",
               "the checksum of a program is wrong");
}

TEST(DriverRequest, TheLongestLine) {
  const std::string longest(DriverRequestReader::kLongestLine, 'x');
  expect_fault(longest + "\n", "a line is no request");
  expect_fault(longest + "x\n", "a line is too long");
  expect_fault(longest + "x", "a line is too long");
  expect_fault(std::string(1'000'000, 'x'), "a line is too long");
}

TEST(DriverRequest, TheLongestProgram) {
  const std::string longest(DriverRequestReader::kLongestProgram, ' ');
  DriverRequestReader reader;
  reader.feed(sent(longest) + "hold\n");
  EXPECT_TRUE(reader.next().value().program == longest);
  EXPECT_EQ(reader.next().value().kind, Kind::hold);
  expect_fault(announced(longest.size() + 1, 0), "a program is too long");
}

}  // namespace
}  // namespace trueblade
