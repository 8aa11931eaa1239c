// The pure parts: lines out of pieces, replies, frames, programs, and the choice of samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hardware/linuxcnc/line_reader.h"
#include "hardware/linuxcnc/rsh_reply.h"
#include "hardware/linuxcnc/sample_frame.h"
#include "hardware/linuxcnc/sample_picker.h"
#include "hardware/linuxcnc/scan_program.h"

namespace trueblade {
namespace {

using Kind = RshReply::Kind;

std::vector<std::string> lines_of(LineReader& reader) {
  std::vector<std::string> lines;
  while (auto line = reader.next()) lines.push_back(*line);
  return lines;
}

TEST(LineReader, PutsHalvesTogetherAndLeavesEmptyLinesOut) {
  const std::string bytes = "HELLO ACK X 1.1\r\nSET MODE ACK\n\rMODE AUTO\r\n\r\n";
  for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
    LineReader reader;
    for (std::size_t at = 0; at < bytes.size(); at += piece)
      reader.feed(std::string_view(bytes).substr(at, piece));
    EXPECT_EQ(lines_of(reader), (std::vector<std::string>{"HELLO ACK X 1.1", "SET MODE ACK", "MODE AUTO"}));
  }
}

TEST(LineReader, LongLinesAndBinaryBytesComeAsNoReply) {
  LineReader reader;
  reader.feed(std::string(LineReader::kLongestLine, 'x') + "\n");
  reader.feed(std::string(5'000'000, 'x'));
  reader.feed("\nok\n" + std::string("a\0b\n", 4) + "\x1b[0m\n");
  EXPECT_EQ(lines_of(reader),
            (std::vector<std::string>{std::string(LineReader::kLongestLine, 'x'), "?", "ok", "?", "?"}));
}

TEST(RshReply, EveryFormThatTheControllerSends) {
  EXPECT_EQ(parse_rsh_reply("HELLO ACK EMCNETSVR 1.1").kind, Kind::hello_accepted);
  EXPECT_EQ(parse_rsh_reply("HELLO NAK").kind, Kind::hello_refused);
  EXPECT_EQ(parse_rsh_reply("SET MODE ACK").kind, Kind::set_accepted);
  EXPECT_EQ(parse_rsh_reply("SET MODE ACK").name, "mode");
  EXPECT_EQ(parse_rsh_reply("SET ENABLE NAK").kind, Kind::set_refused);
  EXPECT_EQ(parse_rsh_reply("GET BOGUS NAK").kind, Kind::get_refused);
  EXPECT_EQ(parse_rsh_reply("set echo off").kind, Kind::unrecognised);
  EXPECT_EQ(parse_rsh_reply("hello EMC trueblade 1.0").kind, Kind::unrecognised);
  EXPECT_EQ(parse_rsh_reply("").kind, Kind::unrecognised);
  EXPECT_EQ(parse_rsh_reply("?").kind, Kind::unrecognised);
  const RshReply error = parse_rsh_reply("ERROR Linear move on line 84 would exceed X's positive limit");
  EXPECT_EQ(error.kind, Kind::value);
  EXPECT_EQ(error.name, "error");
  EXPECT_EQ(error.text, "Linear move on line 84 would exceed X's positive limit");
}

TEST(RshReply, NumbersMustBeNumbers) {
  const RshReply position = parse_rsh_reply("ABS_ACT_POS 1.5 -2 3e-3 45");
  EXPECT_EQ(numbers_of(position, 4), (std::vector<double>{1.5, -2.0, 0.003, 45.0}));
  EXPECT_FALSE(numbers_of(position, 5));
  EXPECT_FALSE(numbers_of(parse_rsh_reply("ABS_ACT_POS 1 2 3 nan"), 4));
  EXPECT_FALSE(numbers_of(parse_rsh_reply("ABS_ACT_POS 1 2 3 4mm"), 4));
  EXPECT_FALSE(numbers_of(parse_rsh_reply("SET MODE ACK"), 0));
}

LatchedSample some_sample(std::uint32_t sequence) {
  LatchedSample sample;
  sample.sequence = sequence;
  sample.axes = {1.25, -2.5, 1.0 / 3.0, 180.0};
  sample.first_point = 17.0;
  sample.program_line = 9;
  sample.distance_mm = 25.001;
  sample.snr = 0.5;
  sample.flags = 2;
  sample.reading = sequence + 5;
  sample.motion_enabled = true;
  return sample;
}

TEST(SampleFrame, ArrivesInAnyPieces) {
  std::string bytes;
  for (std::uint32_t k = 0; k < 3; ++k)
    bytes += frame_bytes(StreamFrame::Type::sample, sample_payload(some_sample(k)));
  for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
    FrameReader reader;
    std::uint32_t found = 0;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      reader.feed(std::string_view(bytes).substr(at, piece));
      while (const auto frame = reader.next()) {
        const auto sample = sample_from_payload(frame->payload);
        ASSERT_TRUE(sample);
        EXPECT_EQ(sample_payload(*sample), sample_payload(some_sample(found++)));
      }
    }
    EXPECT_EQ(found, 3u);
    EXPECT_FALSE(reader.broken());
  }
}

TEST(SampleFrame, AnyDamagedByteIsFound) {
  const std::string bytes = frame_bytes(StreamFrame::Type::sample, sample_payload(some_sample(1)));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x41);
    FrameReader reader;
    reader.feed(damaged + std::string(2048, '\0'));
    EXPECT_FALSE(reader.next()) << at;
    EXPECT_TRUE(reader.broken()) << at;
  }
}

TEST(SampleFrame, NumbersThatAreNotFiniteAreRefused) {
  LatchedSample sample = some_sample(1);
  sample.axes[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(sample_from_payload(sample_payload(sample)));
  EXPECT_FALSE(sample_from_payload(sample_payload(some_sample(1)) + "x"));
  EXPECT_FALSE(sample_from_payload(""));
  EXPECT_FALSE(greeting_from_payload(""));
}

TEST(ScanProgram, SlowsDownWherePositionsAreClose) {
  const std::vector<AxisPositions> path{{0, 0, 0, 0}, {1, 0, 0, 0}, {1.01, 0, 0, 0}};
  const std::string program = scan_program(path, 7, 2, {0.001, 50.0});
  EXPECT_EQ(program,
            "G21 G90 G94 G17 G40 G49 G64 P0.005 Q0\nM68 E1 Q2\nM68 E0 Q7\nG4 P0.02\n"
            "G53 G1 X0.0000000 Y0.0000000 Z0.0000000 C0.0000000 F3000.000000\n"
            "G53 G1 X1.0000000 Y0.0000000 Z0.0000000 C0.0000000 F3000.000000\n"
            "G53 G1 X1.0100000 Y0.0000000 Z0.0000000 C0.0000000 F300.000000\n"
            "M68 E0 Q-1\nM2\n");
}

// 0.05 mm a servo period. The program line changes at a position, half way to it (as the controller does in
// blended corners), or some periods ahead of the encoders: every position gets the sample at it, within half
// a period, in order.
TEST(SamplePicker, FindsTheNearestSample) {
  std::vector<AxisPositions> path;
  for (int k = 0; k < 30; ++k) path.push_back({static_cast<double>(k), 0, 0, 0});
  for (const double ahead_mm : {0.0, 0.1, 0.25, 0.5}) {
    SamplePicker picker(path, 100);
    std::vector<double> picked;
    const auto pick = [&](std::size_t position, const LatchedSample& sample) {
      EXPECT_EQ(position, picked.size());
      picked.push_back(sample.axes[0]);
      return true;
    };
    std::uint32_t period = 0;
    const auto at = [&](double x, double first, std::int32_t line) {
      LatchedSample sample;
      sample.axes[0] = x;
      sample.first_point = first;
      sample.program_line = line;
      sample.reading = ++period;
      picker.take(sample, pick);
    };
    at(0, -1, 0);
    for (int k = 0; k < 10; ++k) at(0, 100, 0);
    for (int n = 0; n <= 580; ++n) {
      const double x = std::min(0.05 * n + 0.02, 29.0);
      at(x, 100, kFirstPointLine + std::min(29, static_cast<int>(std::ceil(x + ahead_mm))));
    }
    at(29, 100, 0);
    EXPECT_FALSE(picker.finished());
    at(29, -1, 0);
    EXPECT_TRUE(picker.finished());
    ASSERT_EQ(picked.size(), 30u);
    // At ahead_mm = 0 the line changes in the very period that passes the position: up to a whole period.
    for (int k = 0; k < 30; ++k)
      EXPECT_NEAR(picked[static_cast<std::size_t>(k)], k, ahead_mm == 0.0 ? 0.05 : 0.0301) << ahead_mm;
  }
}

TEST(SamplePicker, AControllerOutOfStepIsAFault) {
  const std::vector<AxisPositions> path(3);
  SamplePicker picker(path, 0);
  const auto pick = [](std::size_t, const LatchedSample&) { return true; };
  LatchedSample sample;
  sample.first_point = 0;
  sample.program_line = kFirstPointLine + 2;
  sample.reading = 1;
  picker.take(sample, pick);
  sample.reading = 2;
  sample.program_line = kFirstPointLine + 1;
  EXPECT_THROW(picker.take(sample, pick), MachineFault);
  sample.program_line = kFirstPointLine + 3;
  EXPECT_THROW(picker.take(sample, pick), MachineFault);
}

}  // namespace
}  // namespace trueblade
