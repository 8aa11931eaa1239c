// What the driver asks of trueblade-hal over the network: lines samples, quiet, watch, alive, release, hold,
// and "program BYTES CRC32" (both decimal) followed by that many bytes. Lines end with LF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace trueblade {

struct DriverRequest {
  enum class Kind {
    samples,  // send what is latched
    quiet,    // no more of it
    watch,    // expect signs of life from now on
    alive,    // one of them
    release,  // expect none any more
    hold,     // stop motion now
    program   // keep this program for the controller
  };
  Kind kind = Kind::quiet;
  std::string program;  // of Kind::program, as its checksum says
};

// Takes any bytes, in whatever pieces. It keeps no more than a line or a program of the longest kind and the
// piece that was fed last, when every piece is read to its end before the next is fed.
class DriverRequestReader {
 public:
  static constexpr std::size_t kLongestLine = 1024;
  static constexpr std::size_t kLongestProgram = 16u << 20;

  void feed(std::string_view bytes);
  // The next whole request; nullopt when it has not arrived yet, or once there is a fault.
  std::optional<DriverRequest> next();
  // Why what arrived is not the protocol: nothing that follows is read. Empty while all is well.
  std::string_view fault() const { return fault_; }

 private:
  struct Announced {
    std::size_t bytes = 0;
    std::uint32_t checksum = 0;
  };
  static std::optional<Announced> announced_by(std::string_view line);
  std::nullopt_t wait();
  std::nullopt_t end_with(std::string_view fault);

  std::string pending_;
  std::size_t taken_ = 0;             // of what is pending
  std::optional<Announced> program_;  // the one that is arriving
  std::string_view fault_;
};

}  // namespace trueblade
