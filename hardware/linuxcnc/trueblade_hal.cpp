// trueblade-hal: the component beside the controller. It streams what the realtime `sampler` latched in every
// servo period over TCP, takes programs and the driver's signs of life, and stops motion when they stay out.
//
//   loadusr -W trueblade-hal --program FILE --limits "X- Y- Z- C- X+ Y+ Z+ C+" [--port 5008] [--bind
//   127.0.0.1]
//
// Pins: hold (bit, out: stop motion now), watched (bit, out: signs of life are expected), alive (bit, out:
// toggles with each), lost (bit, in: they stayed out), connected (bit, out), samples (u32, out: sent). The
// HAL file wires watched, alive and lost to the realtime `watchdog`, so that this program's own death stops
// motion too.
//
// One driver at a time; its requests are those of driver_request.h. Nothing of it reaches a shell.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

#include "geometry/atomic_file.h"
#include "hardware/linuxcnc/driver_request.h"
#include "hardware/linuxcnc/hal_records.h"
#include "hardware/linuxcnc/sample_stream.h"

namespace trueblade {
namespace {

constexpr std::size_t kMostUnsent = 1u << 20;  // then samples wait in the sampler's own memory
constexpr double kDegree = 3.14159265358979323846 / 180.0;

std::atomic<bool> ended = false;
extern "C" void note_end(int) {
  ended = true;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Options {
  std::string program;
  std::vector<double> limits;
  std::uint16_t port = 5008;
  std::string bind = "127.0.0.1";
  double servo_period_s = 0.001;
};

int listen_on(const Options& options) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options.port);
  if (inet_pton(AF_INET, options.bind.c_str(), &address.sin_addr) != 1)
    throw std::runtime_error("--bind " + options.bind + " is no IPv4 address");
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      ::listen(listener, 4) != 0)
    throw std::runtime_error("cannot listen on " + options.bind + ":" + std::to_string(options.port) + ": " +
                             std::generic_category().message(errno));
  return listener;
}

StreamGreeting greeting_of(const Options& options) {
  const std::vector<double>& l = options.limits;
  StreamGreeting greeting;
  greeting.servo_period_s = options.servo_period_s;
  greeting.limits = {{l[0], l[1], l[2], l[3] * kDegree}, {l[4], l[5], l[6], l[7] * kDegree}};
  greeting.program_file = options.program;
  return greeting;
}

// A driver whose computer or network has died says no goodbye: it is given up after some five seconds without
// an answer to what is sent or, where nothing is, to the probes of TCP. Until then it keeps others out.
void notice_when_gone(int socket) {
  const auto set = [&](int level, int option, int value) {
    ::setsockopt(socket, level, option, &value, sizeof(value));
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 2);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 5000);
}

// The driver that is connected, and what is under way to and from it.
struct Driver {
  int socket;
  std::string unsent;
  DriverRequestReader requests;
  bool wants_samples = false;
};

class Server {
 public:
  explicit Server(const Options& options)
      : options_(options),
        component_("trueblade-hal"),
        hold_(component_, "hold"),
        watched_pin_(component_, "watched"),
        alive_(component_, "alive"),
        lost_(component_, "lost"),
        connected_(component_, "connected"),
        sent_pin_(component_, "samples"),
        stream_(component_, HalStream::End::sampler, kSampleChannel, kSampleFields),
        listener_(listen_on(options)) {
    component_.ready();
  }
  ~Server() {
    drop_driver();
    ::close(listener_);
  }

  void run() {
    while (!ended) {
      wait();
      accept_driver();
      pass_samples();
      tell_of_lost_signs();
      if (driver_ && !(receive() && send())) drop_driver();
    }
  }

 private:
  void wait() const {
    pollfd entries[2] = {{listener_, POLLIN, 0}, {driver_ ? driver_->socket : -1, POLLIN, 0}};
    ::poll(entries, 2, 1);  // a millisecond: the sampler has no file descriptor to wait for
  }

  void accept_driver() {
    const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket < 0) return;
    if (driver_ && !receive()) drop_driver();  // the same one, perhaps, that has closed and comes back
    if (driver_) {
      const std::string refusal = frame_bytes(StreamFrame::Type::refused, "another driver is connected");
      [[maybe_unused]] const auto ignored =
          ::send(socket, refusal.data(), refusal.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      ::close(socket);
      return;
    }
    notice_when_gone(socket);
    driver_ = Driver{
        socket, frame_bytes(StreamFrame::Type::greeting, greeting_payload(greeting_of(options_))), {}, false};
    connected_.set(true);
  }

  void drop_driver() {
    if (!driver_) return;
    ::close(driver_->socket);
    driver_.reset();
    connected_.set(false);
    if (watched_) hold_.set(true);  // it went without releasing the watch: it did not mean to
  }

  void pass_samples() {
    while (!driver_ || driver_->unsent.size() < kMostUnsent) {
      const auto record = stream_.read();
      if (!record) return;
      if (!driver_ || !driver_->wants_samples) continue;
      driver_->unsent += frame_bytes(StreamFrame::Type::sample, sample_payload(latched_sample(*record)));
      sent_pin_.set(++sent_);
    }
  }

  // A driver that is only slow or far away does not know that its motion is over. The watchdog cannot bite
  // before its time; until then the pin may still say what was before the watch.
  void tell_of_lost_signs() {
    if (!driver_ || !watched_ || loss_told_ || !lost_.get()) return;
    if (seconds_since(watched_since_) < SampleStream::kWatchdogS) return;
    longest_silence_s_ = std::max(longest_silence_s_, seconds_since(last_sign_));
    const std::string words = fmt::format(
        "the longest silence here was {:.2f} s{}", longest_silence_s_,
        longest_silence_s_ < SampleStream::kWatchdogS ? ": the controller's own computer stood still" : "");
    std::fprintf(stderr, "trueblade-hal: the watchdog has ended motion; %s\n", words.c_str());
    driver_->unsent += frame_bytes(StreamFrame::Type::motion_ended, words);
    loss_told_ = true;
  }

  void note_sign_of_life() {
    longest_silence_s_ = std::max(longest_silence_s_, seconds_since(last_sign_));
    last_sign_ = std::chrono::steady_clock::now();
    sign_noted_ = true;
  }

  // Once for all that came together: two changes of the pin within a servo period are none.
  void show_sign_of_life() {
    if (sign_noted_) alive_.set(life_ = !life_);
    sign_noted_ = false;
  }

  // False when the driver is gone, or what it sends is not the protocol: the connection is then closed.
  bool receive() {
    char bytes[65536];
    for (;;) {
      const ssize_t received = ::recv(driver_->socket, bytes, sizeof(bytes), 0);
      if (received == 0) return false;
      if (received < 0) {
        show_sign_of_life();
        return errno == EAGAIN || errno == EINTR;
      }
      DriverRequestReader& requests = driver_->requests;
      requests.feed({bytes, static_cast<std::size_t>(received)});
      while (const auto request = requests.next()) obey(*request);
      if (requests.fault().empty()) continue;
      std::fprintf(stderr, "trueblade-hal: connection closed: %s\n", std::string(requests.fault()).c_str());
      return false;
    }
  }

  bool send() {
    std::string& unsent = driver_->unsent;
    while (!unsent.empty()) {
      const ssize_t count = ::send(driver_->socket, unsent.data(), unsent.size(), MSG_NOSIGNAL);
      if (count < 0) return errno == EAGAIN || errno == EINTR;
      unsent.erase(0, static_cast<std::size_t>(count));
    }
    return true;
  }

  void obey(const DriverRequest& request) {
    switch (request.kind) {
      case DriverRequest::Kind::samples:
        driver_->wants_samples = true;
        driver_->unsent += frame_bytes(StreamFrame::Type::samples_begin, "");
        break;
      case DriverRequest::Kind::quiet:
        driver_->wants_samples = false;
        break;
      case DriverRequest::Kind::watch:
        watch();
        break;
      case DriverRequest::Kind::alive:
        note_sign_of_life();
        break;
      case DriverRequest::Kind::release:
        watched_pin_.set(watched_ = false);
        break;
      case DriverRequest::Kind::hold:
        hold_.set(true);
        loss_told_ = true;  // nothing is left to be ended
        break;
      case DriverRequest::Kind::program:
        store(request.program);
        break;
    }
  }

  // A watchdog that has bitten bites on until its enable pin has been low for a servo period; on a busy
  // computer a period may be late, and the pin says so. The hold ends last.
  void watch() {
    constexpr int kMostTries = 50;
    const auto some_periods = std::chrono::duration<double>(3.0 * options_.servo_period_s);
    for (int tried = 0; tried == 0 || (lost_.get() && tried < kMostTries); ++tried) {
      watched_pin_.set(false);
      std::this_thread::sleep_for(some_periods);
      alive_.set(life_ = !life_);
      watched_pin_.set(watched_ = true);
      std::this_thread::sleep_for(some_periods);
    }
    watched_since_ = last_sign_ = std::chrono::steady_clock::now();
    longest_silence_s_ = 0.0;
    loss_told_ = false;
    hold_.set(false);
  }

  void store(const std::string& program) {
    try {
      write_file_atomically(options_.program, [&](std::ostream& out) { out << program; });
    } catch (const std::exception& failure) {
      driver_->unsent += frame_bytes(StreamFrame::Type::refused,
                                     std::string(failure.what()).substr(0, FrameReader::kLongestPayload));
      return;
    }
    driver_->unsent += frame_bytes(StreamFrame::Type::program_stored, "");
  }

  Options options_;
  HalComponent component_;
  HalBitOut hold_, watched_pin_, alive_;
  HalBitIn lost_;
  HalBitOut connected_;
  HalCountOut sent_pin_;
  HalStream stream_;
  int listener_;
  std::optional<Driver> driver_;
  bool watched_ = false, life_ = false, loss_told_ = false;
  bool sign_noted_ = false;
  std::chrono::steady_clock::time_point watched_since_, last_sign_;
  double longest_silence_s_ = 0.0;  // since watched_since_
  std::uint32_t sent_ = 0;
};

int run(int argument_count, char** arguments) {
  Options options;
  CLI::App app("Streams latched samples of a LinuxCNC machine to trueblade.", "trueblade-hal");
  app.add_option("--program", options.program, "Where the controller finds the program that is sent")
      ->required();
  app.add_option("--limits", options.limits, "Lower, then upper limits of x, y, z (mm) and c (degrees)")
      ->required()
      ->expected(8);
  app.add_option("--port", options.port, "TCP port");
  app.add_option("--bind", options.bind, "Address to listen on");
  app.add_option("--servo-period", options.servo_period_s, "Of the servo thread, in seconds");
  CLI11_PARSE(app, argument_count, arguments);
  std::signal(SIGINT, note_end);
  std::signal(SIGTERM, note_end);
  try {
    Server(options).run();
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "trueblade-hal: %s\n", failure.what());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace trueblade

int main(int argument_count, char** arguments) {
  return trueblade::run(argument_count, arguments);
}
