// The driver's end of the connection to trueblade-hal, the component beside the controller: samples come,
// programs, signs of life and the stop go.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "hardware/linuxcnc/sample_frame.h"
#include "hardware/linuxcnc/tcp_connection.h"

namespace trueblade {

class SampleStream {
 public:
  // Throws MachineFault: connection (nobody there, no greeting within the time, taken by another driver) or
  // protocol.
  SampleStream(const std::string& host, std::uint16_t port, double timeout_s);

  const StreamGreeting& greeting() const { return greeting_; }

  // Samples come from here on, one every servo period, until they are stopped; what was still under way from
  // before is passed over.
  void start_samples();
  void stop_samples();
  // The next sample, or nullopt when none came within `wait_s`. While the watch is set, also sends the sign
  // of life. Throws MachineFault: sensor (samples were lost or doubled on the way), interrupted (the signs of
  // life came too late, and the controller has ended the motion), connection, protocol.
  std::optional<LatchedSample> next(double wait_s);
  // One sample of the present moment. Precondition: samples are stopped.
  LatchedSample present();

  // Hands the controller a program. Throws MachineFault.
  void store_program(const std::string& program);

  // From here to release_watch the controller stops all motion when the signs of life stay out for
  // kWatchdogS: whether this program, its machine or the line has died.
  static constexpr double kWatchdogS = 0.5;
  void set_watch();
  void release_watch();
  // The sign of life, when it is due and the watch is set: for whoever waits for something else than a
  // sample.
  void keep_watch();
  // Motion stops in the next servo period. Safe from any thread.
  bool hold() noexcept { return connection_.send_now("hold\n"); }

 private:
  std::optional<StreamFrame> next_frame(double wait_s);
  void await(StreamFrame::Type answer, const std::string& request);

  double timeout_s_;
  TcpConnection connection_;
  FrameReader reader_;
  StreamGreeting greeting_;
  std::optional<LatchedSample> last_;
  bool watched_ = false;
  std::chrono::steady_clock::time_point last_sign_;
};

}  // namespace trueblade
