#include "tests/linuxcnc/scripted_controller.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "hardware/linuxcnc/scan_program.h"

namespace trueblade {
namespace {

constexpr std::size_t kSamplesPerPosition = 3;

int listen_anywhere(std::uint16_t& port) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  if (::bind(listener, reinterpret_cast<sockaddr*>(&address), length) != 0 || ::listen(listener, 4) != 0 ||
      ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length) != 0)
    throw std::runtime_error("cannot listen on the loopback");
  port = ntohs(address.sin_port);
  return listener;
}

void put(int socket, const std::string& bytes) {
  [[maybe_unused]] const auto ignored = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

void shut(int& socket) {
  if (socket >= 0) ::close(socket);
  socket = -1;
}

}  // namespace

ScriptedController::ScriptedController(Misbehaviour misbehaviour)
    : misbehaviour_(std::move(misbehaviour)),
      command_listener_(listen_anywhere(command_port_)),
      stream_listener_(listen_anywhere(stream_port_)),
      thread_([this] { serve(); }) {}

ScriptedController::~ScriptedController() {
  ended_ = true;
  thread_.join();
  for (int* socket : {&commands_, &stream_, &command_listener_, &stream_listener_}) shut(*socket);
}

LinuxCncSettings ScriptedController::settings() const {
  LinuxCncSettings settings;
  settings.commands.port = command_port_;
  settings.sample_port = stream_port_;
  settings.commands.timeout_s = 0.5;
  settings.home_timeout_s = 1.0;
  settings.sensor_timeout_s = 0.2;
  settings.reset_estop = true;
  return settings;
}

void ScriptedController::serve() {
  while (!ended_) {
    pollfd entries[4] = {{command_listener_, POLLIN, 0},
                         {stream_listener_, POLLIN, 0},
                         {commands_, POLLIN, 0},
                         {stream_, POLLIN, 0}};
    ::poll(entries, 4, 1);
    if (entries[0].revents & POLLIN) {
      shut(commands_);
      commands_ = ::accept(command_listener_, nullptr, nullptr);
      command_bytes_.clear();
      late_replies_.clear();
    }
    if (entries[1].revents & POLLIN) {
      shut(stream_);
      stream_ = ::accept(stream_listener_, nullptr, nullptr);
      stream_bytes_.clear();
      wants_samples_ = expects_program_ = false;
      StreamGreeting greeting{0.001, {{-500, -500, -500, -100}, {500, 500, 500, 100}}, "/scripted.ngc"};
      send_stream_answer(frame_bytes(StreamFrame::Type::greeting, greeting_payload(greeting)));
    }
    const auto take = [&](int& socket, short events, std::string& bytes) {
      if (socket < 0 || !(events & (POLLIN | POLLHUP))) return;
      char buffer[65536];
      const auto received = ::recv(socket, buffer, sizeof(buffer), MSG_DONTWAIT);
      if (received > 0) bytes.append(buffer, static_cast<std::size_t>(received));
      if (received == 0) shut(socket);
    };
    take(commands_, entries[2].revents, command_bytes_);
    take(stream_, entries[3].revents, stream_bytes_);
    for (std::size_t end; commands_ >= 0 && (end = command_bytes_.find("\r\n")) != std::string::npos;) {
      const std::string line = command_bytes_.substr(0, end);
      command_bytes_.erase(0, end + 2);
      if (!send_reply(answer(line))) shut(commands_);
    }
    send_late_replies();
    while (stream_ >= 0) {
      if (expects_program_) {
        if (stream_bytes_.size() < program_bytes_) break;
        load_program(stream_bytes_.substr(0, program_bytes_));
        stream_bytes_.erase(0, program_bytes_);
        expects_program_ = false;
        send_stream_answer(frame_bytes(StreamFrame::Type::program_stored, ""));
        continue;
      }
      const std::size_t end = stream_bytes_.find('\n');
      if (end == std::string::npos) break;
      obey_stream(stream_bytes_.substr(0, end));
      stream_bytes_.erase(0, end + 1);
    }
    // One servo period.
    ++present_.sequence;
    ++present_.reading;
    present_.motion_enabled = on_;
    if (homing_left_ > 0 && misbehaviour_.watchdog_ends_homing) {
      homing_left_ = 0;
      put(stream_, frame_bytes(StreamFrame::Type::motion_ended, ""));
    }
    if (homing_left_ > 0 && --homing_left_ == 0) homed_ = true;
    const bool moves = running_ && !held_ && program_at_ < program_.size();
    if (moves) {
      LatchedSample next = program_[program_at_++];
      next.sequence = present_.sequence;
      next.reading = present_.reading;
      next.motion_enabled = !(misbehaviour_.in_estop && program_at_ > 10);
      next.distance_mm = 10.0 + 0.001 * next.axes[0];
      next.snr = 0.75;
      present_ = next;
    }
    if (running_ && program_at_ == program_.size()) running_ = false;
    if (stream_ >= 0 && wants_samples_) send_sample(present_, moves);
  }
}

std::string ScriptedController::answer(const std::string& line) {
  std::istringstream words(line);
  std::string verb, name, value;
  words >> verb >> name >> value;
  if (verb == "hello") return name == "EMC" ? "HELLO ACK EMCNETSVR 1.1\r\n" : "HELLO NAK\r\n";
  if (verb == "get") {
    const auto reply = [&](const std::string& text) {
      std::string upper = name;
      for (char& letter : upper) letter = static_cast<char>(std::toupper(letter));
      return upper + " " + text + "\r\n";
    };
    if (name == "estop") return reply(misbehaviour_.in_estop && program_at_ > 0 ? "ON" : "OFF");
    if (name == "machine") return reply(on_ ? "ON" : "OFF");
    if (name == "mode") return reply(mode_);
    if (name == "user_linear_units") return reply("MM");
    if (name == "user_angular_units") return reply("DEG");
    if (name == "joint_homed") return reply(homed_ ? "YES YES YES YES NO" : "NO NO NO NO NO");
    if (name == "joint_limit") return reply(misbehaviour_.at_limit ? "OK MAXSOFT OK OK" : "OK OK OK OK");
    if (name == "joint_fault") return reply(misbehaviour_.joint_fault ? "OK FAULT OK OK" : "OK OK OK OK");
    if (name == "program_status") return reply(running_ ? "RUNNING" : "IDLE");
    if (name == "error") {
      // Words from before the session are of no interest; those about the program are.
      if (program_.empty()) return reply("OK");
      return reply(std::exchange(misbehaviour_.error_words, "OK"));
    }
    return "GET " + name + " NAK\r\n";
  }
  if (name == "echo") return "set echo off\r\n";
  if (name == "enable" && value != "EMCTOO") return "SET ENABLE NAK\n\r";
  if (name == "machine") on_ = true;
  if (name == "home") homing_left_ = 1 + misbehaviour_.homing_periods;
  if (name == "mode") mode_ = value == "auto" ? "AUTO" : "MANUAL";
  if (name == "run") running_ = true;
  if (name == "abort") {
    aborted_ = true;
    running_ = false;
    homing_left_ = 0;
  }
  std::string upper = name;
  for (char& letter : upper) letter = static_cast<char>(std::toupper(letter));
  return "SET " + upper + " ACK\n\r";
}

void ScriptedController::obey_stream(const std::string& line) {
  unsigned long bytes = 0;
  if (line == "samples") {
    wants_samples_ = true;
    send_stream_answer(frame_bytes(StreamFrame::Type::samples_begin, ""));
  }
  if (line == "quiet") wants_samples_ = false;
  if (line == "hold") held_ = true;
  const auto now = std::chrono::steady_clock::now();
  if (line == "watch") {
    watched_ = true;
    held_ = false;
  } else if (line == "alive" || line == "release") {
    const double silent_s = std::chrono::duration<double>(now - last_sign_).count();
    longest_without_sign_s_ = std::max(longest_without_sign_s_.load(), silent_s);
  }
  if (line == "watch" || line == "alive") last_sign_ = now;
  if (std::sscanf(line.c_str(), "program %lu", &bytes) == 1) {
    program_bytes_ = bytes;
    expects_program_ = true;
  }
}

// M68 E0 and G53 moves, a few samples each: on the way, and at the target.
void ScriptedController::load_program(const std::string& text) {
  program_.clear();
  program_at_ = program_samples_ = 0;
  running_ = false;
  LatchedSample at = present_;
  std::istringstream lines(text);
  std::string line;
  for (std::int32_t number = 1; std::getline(lines, line); ++number) {
    std::array<double, 4> target{};
    double value = 0.0;
    if (std::sscanf(line.c_str(), "M68 E0 Q%lf", &value) == 1) {
      at.first_point = value;
      at.program_line = 0;
      program_.push_back(at);
      program_.push_back(at);
    }
    const char* moves = line.c_str() + (line.starts_with("G53 G") ? 7 : 0);
    if (std::sscanf(moves, "X%lf Y%lf Z%lf C%lf", &target[0], &target[1], &target[2], &target[3]) != 4)
      continue;
    const std::array<double, 4> from = at.axes;
    at.program_line = number;
    for (std::size_t step = 1; step <= kSamplesPerPosition; ++step) {
      const double share = static_cast<double>(step) / kSamplesPerPosition;
      for (std::size_t k = 0; k < 4; ++k) at.axes[k] = from[k] + share * (target[k] - from[k]);
      program_.push_back(at);
    }
  }
}

bool ScriptedController::send_reply(const std::string& reply) {
  const std::size_t number = replies_++;
  const auto sent = misbehaviour_.replies ? misbehaviour_.replies(number, reply) : std::optional(reply);
  if (!sent) return false;
  const double delay_s = misbehaviour_.delay_s ? misbehaviour_.delay_s(number) : 0.0;
  using Clock = std::chrono::steady_clock;
  late_replies_.push_back(
      {Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(delay_s)),
       *sent});
  return true;
}

void ScriptedController::send_late_replies() {
  const auto now = std::chrono::steady_clock::now();
  for (; !late_replies_.empty() && late_replies_.front().due <= now; late_replies_.pop_front())
    if (commands_ >= 0) put(commands_, late_replies_.front().text);
}

void ScriptedController::send_stream_answer(const std::string& frame) {
  const std::size_t number = stream_answers_++;
  const auto sent =
      misbehaviour_.stream_answers ? misbehaviour_.stream_answers(number, frame) : std::optional(frame);
  if (sent)
    put(stream_, *sent);
  else
    shut(stream_);
}

void ScriptedController::send_sample(const LatchedSample& sample, bool scripted) {
  const std::string frame = frame_bytes(StreamFrame::Type::sample, sample_payload(sample));
  if (!scripted || !misbehaviour_.samples) {
    put(stream_, frame);
    return;
  }
  const auto sent = misbehaviour_.samples(program_samples_++, sample);
  if (sent)
    put(stream_, *sent);
  else
    shut(stream_);
}

}  // namespace trueblade
