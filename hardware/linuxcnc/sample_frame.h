// What trueblade-hal sends over the network: frames of magic (4 bytes), type (1), length (2), payload and
// CRC-32, little endian. Readers take any bytes; what is no frame is found out and never trusted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hardware/machine_driver.h"

namespace trueblade {

// One servo period: where the axes stood, and what the probe says about exactly that place.
struct LatchedSample {
  std::uint32_t sequence = 0;  // of the servo period; a gap is a loss
  // x, y, z (mm) and theta (degrees, as the controller counts them).
  std::array<double, 4> axes{};
  double first_point = -1.0;      // number of the running program's first point; negative: none is measured
  std::int32_t program_line = 0;  // that the controller is carrying out; 0: none
  double distance_mm = 0.0;
  double snr = 0.0;
  std::uint8_t flags = 0;     // ProbeFlags
  std::uint32_t reading = 0;  // number of the sensor's reading: unchanged when it has nothing new to say
  bool motion_enabled = false;
};

// What of it the driver hands out. `period_s`: of the servo thread.
ProbeSample probe_sample(const LatchedSample& latched, double period_s);
AxisPositions axis_positions(const LatchedSample& latched);

struct StreamGreeting {
  double servo_period_s = 0.001;
  AxisLimits limits;         // the controller's own
  std::string program_file;  // where it finds the program that is sent to it
};

struct StreamFrame {
  enum class Type : std::uint8_t {
    greeting = 1,
    sample = 2,
    program_stored = 3,
    refused = 4,  // the reason in words
    samples_begin = 5,
    motion_ended = 6  // by the watchdog, as the signs of life stayed out; what is known of it in words
  };
  Type type;
  std::string payload;
};

std::string frame_bytes(StreamFrame::Type type, std::string_view payload);
std::string sample_payload(const LatchedSample& sample);
std::optional<LatchedSample> sample_from_payload(std::string_view payload);  // nullopt: malformed, not finite
std::string greeting_payload(const StreamGreeting& greeting);
std::optional<StreamGreeting> greeting_from_payload(std::string_view payload);

class FrameReader {
 public:
  static constexpr std::size_t kLongestPayload = 1024;

  void feed(std::string_view bytes) { pending_ += bytes; }
  // The next whole frame; nullopt when it has not arrived yet, or once the stream is broken.
  std::optional<StreamFrame> next();
  // What arrived is no frame, or its checksum is wrong: nothing that follows can be trusted.
  bool broken() const { return broken_; }

 private:
  std::string pending_;
  std::size_t taken_ = 0;
  bool broken_ = false;
};

}  // namespace trueblade
