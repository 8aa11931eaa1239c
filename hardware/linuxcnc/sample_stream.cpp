#include "hardware/linuxcnc/sample_stream.h"

#include <fmt/format.h>

#include <algorithm>

#include "hardware/bytes.h"

namespace trueblade {
namespace {

using Clock = std::chrono::steady_clock;
// Ten signs of life in the watchdog's time.
constexpr double kSignOfLifeS = 0.05;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

MachineFault protocol_fault(const std::string& what) {
  return MachineFault(MachineFault::Kind::protocol, "trueblade-hal: " + what);
}

}  // namespace

SampleStream::SampleStream(const std::string& host, std::uint16_t port, double timeout_s)
    : timeout_s_(timeout_s), connection_(host, port, timeout_s) {
  const auto frame = next_frame(timeout_s);
  if (!frame)
    throw MachineFault(MachineFault::Kind::connection,
                       fmt::format("trueblade-hal at {}:{}: no greeting within {} s", host, port, timeout_s));
  if (frame->type == StreamFrame::Type::refused)
    throw MachineFault(MachineFault::Kind::connection, "trueblade-hal: " + frame->payload);
  const auto greeting = greeting_from_payload(frame->payload);
  if (frame->type != StreamFrame::Type::greeting || !greeting)
    throw protocol_fault("what it sent first is no greeting of version 1");
  greeting_ = *greeting;
}

std::optional<StreamFrame> SampleStream::next_frame(double wait_s) {
  const auto start = Clock::now();
  for (bool waited = false;; waited = true) {
    keep_watch();
    if (auto frame = reader_.next()) return frame;
    if (reader_.broken())
      throw protocol_fault("the stream of samples is broken (no frame, or a wrong checksum)");
    const double left_s = wait_s - seconds_since(start);
    if (waited && left_s <= 0.0) return std::nullopt;
    reader_.feed(connection_.receive(std::clamp(left_s, 0.0, kSignOfLifeS)));
  }
}

void SampleStream::await(StreamFrame::Type answer, const std::string& request) {
  const auto start = Clock::now();
  while (seconds_since(start) < timeout_s_) {
    const auto frame = next_frame(timeout_s_);
    if (!frame) break;
    if (frame->type == StreamFrame::Type::refused) throw protocol_fault(frame->payload);
    if (frame->type == answer) return;
  }
  throw MachineFault(MachineFault::Kind::connection,
                     fmt::format("trueblade-hal: no answer to \"{}\" within {} s", request, timeout_s_));
}

void SampleStream::start_samples() {
  connection_.send_all("samples\n", timeout_s_);
  await(StreamFrame::Type::samples_begin, "samples");
  last_.reset();
}

void SampleStream::stop_samples() {
  connection_.send_all("quiet\n", timeout_s_);
}

std::optional<LatchedSample> SampleStream::next(double wait_s) {
  const auto frame = next_frame(wait_s);
  if (!frame) return std::nullopt;
  if (frame->type == StreamFrame::Type::refused) throw protocol_fault(frame->payload);
  if (frame->type == StreamFrame::Type::motion_ended)
    throw MachineFault(MachineFault::Kind::interrupted,
                       fmt::format("trueblade-hal: no sign of life came for {} s, and the controller has "
                                   "ended the motion; {}",
                                   kWatchdogS, frame->payload));
  const auto sample = sample_from_payload(frame->payload);
  if (frame->type != StreamFrame::Type::sample || !sample) throw protocol_fault("sent what is no sample");
  if (last_ && sample->sequence != last_->sequence + 1)
    throw MachineFault(MachineFault::Kind::sensor,
                       fmt::format("trueblade-hal: after sample {} came {}: samples were lost or doubled",
                                   last_->sequence, sample->sequence));
  last_ = sample;
  return sample;
}

LatchedSample SampleStream::present() {
  start_samples();
  const auto sample = next(timeout_s_);
  if (!sample)
    throw MachineFault(MachineFault::Kind::sensor,
                       fmt::format("trueblade-hal: no sample within {} s", timeout_s_));
  stop_samples();
  return *sample;
}

void SampleStream::store_program(const std::string& program) {
  connection_.send_all(fmt::format("program {} {}\n", program.size(), crc32_of(program)), timeout_s_);
  connection_.send_all(program, timeout_s_);
  await(StreamFrame::Type::program_stored, "program");
}

void SampleStream::keep_watch() {
  if (!watched_ || seconds_since(last_sign_) < kSignOfLifeS) return;
  connection_.send_all("alive\n", timeout_s_);
  last_sign_ = Clock::now();
}

void SampleStream::set_watch() {
  connection_.send_all("watch\n", timeout_s_);
  last_sign_ = Clock::now();
  watched_ = true;
}

void SampleStream::release_watch() {
  watched_ = false;
  connection_.send_all("release\n", timeout_s_);
}

}  // namespace trueblade
