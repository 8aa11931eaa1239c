#include "hardware/linuxcnc/sample_frame.h"

#include <cmath>
#include <numbers>

#include "hardware/bytes.h"

namespace trueblade {
namespace {

constexpr std::uint32_t kMagic = 0x31464254;  // "TBF1"
constexpr std::size_t kHeadBytes = 4 + 1 + 2;
constexpr std::uint8_t kProtocolVersion = 1;
constexpr auto kLastType = static_cast<std::uint8_t>(StreamFrame::Type::motion_ended);
constexpr double kDegree = std::numbers::pi / 180.0;

std::array<double*, 8> numbers_of(AxisLimits& limits) {
  return {&limits.lower.x_mm, &limits.lower.y_mm, &limits.lower.z_mm, &limits.lower.theta_rad,
          &limits.upper.x_mm, &limits.upper.y_mm, &limits.upper.z_mm, &limits.upper.theta_rad};
}

}  // namespace

AxisPositions axis_positions(const LatchedSample& latched) {
  return {latched.axes[0], latched.axes[1], latched.axes[2], latched.axes[3] * kDegree};
}

ProbeSample probe_sample(const LatchedSample& latched, double period_s) {
  ProbeSample sample;
  sample.axes = axis_positions(latched);
  sample.distance_mm = latched.distance_mm;
  sample.snr = latched.snr;
  sample.time_s = period_s * latched.sequence;
  sample.flags = ProbeFlags::from_bits(latched.flags);
  return sample;
}

std::string frame_bytes(StreamFrame::Type type, std::string_view payload) {
  std::string bytes;
  append_bytes(bytes, kMagic);
  append_bytes(bytes, static_cast<std::uint8_t>(type));
  append_bytes(bytes, static_cast<std::uint16_t>(payload.size()));
  bytes += payload;
  append_bytes(bytes, crc32_of(std::string_view(bytes).substr(sizeof(kMagic))));
  return bytes;
}

std::string sample_payload(const LatchedSample& sample) {
  std::string bytes;
  append_bytes(bytes, sample.sequence);
  for (const double axis : sample.axes) append_bytes(bytes, axis);
  append_bytes(bytes, sample.first_point);
  append_bytes(bytes, sample.program_line);
  append_bytes(bytes, sample.distance_mm);
  append_bytes(bytes, sample.snr);
  append_bytes(bytes, sample.flags);
  append_bytes(bytes, sample.reading);
  append_bytes(bytes, static_cast<std::uint8_t>(sample.motion_enabled));
  return bytes;
}

std::optional<LatchedSample> sample_from_payload(std::string_view payload) {
  ByteReader in(payload);
  LatchedSample sample;
  bool finite = true;
  const auto take_number = [&] {
    const double value = in.take<double>();
    finite = finite && std::isfinite(value);
    return value;
  };
  sample.sequence = in.take<std::uint32_t>();
  for (double& axis : sample.axes) axis = take_number();
  sample.first_point = take_number();
  sample.program_line = in.take<std::int32_t>();
  sample.distance_mm = take_number();
  sample.snr = take_number();
  sample.flags = in.take<std::uint8_t>();
  sample.reading = in.take<std::uint32_t>();
  sample.motion_enabled = in.take<std::uint8_t>() != 0;
  if (!in.finished() || !finite) return std::nullopt;
  return sample;
}

std::string greeting_payload(const StreamGreeting& greeting) {
  std::string bytes;
  append_bytes(bytes, kProtocolVersion);
  append_bytes(bytes, greeting.servo_period_s);
  AxisLimits limits = greeting.limits;
  for (const double* number : numbers_of(limits)) append_bytes(bytes, *number);
  return bytes + greeting.program_file;
}

std::optional<StreamGreeting> greeting_from_payload(std::string_view payload) {
  ByteReader in(payload);
  StreamGreeting greeting;
  if (in.take<std::uint8_t>() != kProtocolVersion) return std::nullopt;
  greeting.servo_period_s = in.take<double>();
  bool finite = greeting.servo_period_s > 0.0 && greeting.servo_period_s <= 1.0;
  for (double* number : numbers_of(greeting.limits)) {
    *number = in.take<double>();
    finite = finite && std::isfinite(*number);
  }
  greeting.program_file = in.rest();
  for (const char letter : greeting.program_file)
    finite = finite && static_cast<unsigned char>(letter) >= 0x20;
  if (in.failed() || !finite || greeting.program_file.empty()) return std::nullopt;
  return greeting;
}

std::optional<StreamFrame> FrameReader::next() {
  if (broken_) return std::nullopt;
  const std::string_view bytes = std::string_view(pending_).substr(taken_);
  // What was taken is dropped in large pieces, so that a long stream costs no quadratic copying.
  const auto wait = [&]() -> std::optional<StreamFrame> {
    pending_.erase(0, taken_);
    taken_ = 0;
    return std::nullopt;
  };
  if (bytes.size() < kHeadBytes) return wait();
  ByteReader head(bytes);
  const auto magic = head.take<std::uint32_t>();
  const auto type = head.take<std::uint8_t>();
  const auto length = head.take<std::uint16_t>();
  if (magic != kMagic || type < 1 || type > kLastType || length > kLongestPayload) {
    broken_ = true;
    return std::nullopt;
  }
  if (bytes.size() < kHeadBytes + length + sizeof(std::uint32_t)) return wait();
  ByteReader checksum(bytes.substr(kHeadBytes + length));
  if (checksum.take<std::uint32_t>() !=
      crc32_of(bytes.substr(sizeof(kMagic), kHeadBytes - sizeof(kMagic) + length))) {
    broken_ = true;
    return std::nullopt;
  }
  StreamFrame frame{static_cast<StreamFrame::Type>(type), std::string(bytes.substr(kHeadBytes, length))};
  taken_ += kHeadBytes + length + sizeof(std::uint32_t);
  return frame;
}

}  // namespace trueblade
