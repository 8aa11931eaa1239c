// A controller for tests: speaks linuxcncrsh's and trueblade-hal's protocols on two ports of the loopback,
// carries out programs of straight moves, and misbehaves on demand, as the real one will not.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <thread>

#include "hardware/linuxcnc/linuxcnc_machine.h"

namespace trueblade {

struct Misbehaviour {
  // What is sent instead of reply number n (from 0) of the command side; the proper reply is given. nullopt:
  // the connection is cut instead. An empty text: silence.
  std::function<std::optional<std::string>(std::size_t n, const std::string& reply)> replies;
  // By how much reply number n is late.
  std::function<double(std::size_t n)> delay_s;
  // As `replies`, for the greeting and the answers of the sample side, as frames.
  std::function<std::optional<std::string>(std::size_t n, const std::string& frame)> stream_answers;
  // The same for sample number n of a program that runs, as frames.
  std::function<std::optional<std::string>(std::size_t n, const LatchedSample& sample)> samples;
  std::string error_words = "OK";  // what `get error` says once
  bool in_estop = false;           // as soon as a program runs
  bool joint_fault = false;
  bool at_limit = false;
  int homing_periods = 0;             // servo periods that homing takes
  bool watchdog_ends_homing = false;  // at once, and only trueblade-hal says so
};

class ScriptedController {
 public:
  explicit ScriptedController(Misbehaviour misbehaviour = {});
  ~ScriptedController();

  LinuxCncSettings settings() const;  // short time-outs
  // The position at which it stands, in the controller's units, after it was told to hold or abort.
  bool was_held() const { return held_; }
  bool was_aborted() const { return aborted_; }
  bool was_watched() const { return watched_; }
  double longest_without_sign_s() const { return longest_without_sign_s_; }  // while it was watched
  std::size_t replies_sent() const { return replies_; }
  std::size_t stream_answers_sent() const { return stream_answers_; }

 private:
  void serve();
  std::string answer(const std::string& line);
  void obey_stream(const std::string& line);
  void load_program(const std::string& text);
  bool send_reply(const std::string& reply);
  void send_late_replies();
  void send_stream_answer(const std::string& frame);
  void send_sample(const LatchedSample& sample, bool scripted);

  Misbehaviour misbehaviour_;
  std::uint16_t command_port_ = 0, stream_port_ = 0;  // before the listeners, which fill them in
  int command_listener_, stream_listener_;
  int commands_ = -1, stream_ = -1;
  std::string command_bytes_, stream_bytes_;
  struct LateReply {
    std::chrono::steady_clock::time_point due;
    std::string text;
  };
  std::deque<LateReply> late_replies_;
  std::size_t program_bytes_ = 0;
  bool expects_program_ = false, wants_samples_ = false;
  std::vector<LatchedSample> program_;
  std::size_t program_at_ = 0, program_samples_ = 0;
  bool running_ = false, homed_ = false, on_ = false;
  int homing_left_ = 0;  // servo periods; 0: is not homing
  std::string mode_ = "MANUAL";
  LatchedSample present_;
  std::atomic<bool> ended_{false}, held_{false}, aborted_{false}, watched_{false};
  std::atomic<double> longest_without_sign_s_{0.0};
  std::chrono::steady_clock::time_point last_sign_;
  std::atomic<std::size_t> replies_{0}, stream_answers_{0};
  std::thread thread_;
};

}  // namespace trueblade
