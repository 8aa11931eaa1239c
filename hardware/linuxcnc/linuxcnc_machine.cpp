#include "hardware/linuxcnc/linuxcnc_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "geometry/error.h"
#include "hardware/linuxcnc/scan_program.h"

namespace trueblade {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = MachineFault::Kind;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The controller's own answers come within milliseconds; asking oftener would only load its network side.
constexpr double kStatusIntervalS = 0.02;
// The axes go off in the servo period of a fault; its words pass through the controller's task and user
// interface, which are not real time.
constexpr double kWordsTimeoutS = 1.0;
// A busy controller takes this long at most to begin a program.
constexpr double kStartTimeoutS = 3.0;
// A program may take three times the estimate and this much for opening and starting it.
constexpr double kProgramOverheadS = 10.0;
// An axis that has arrived stands within the encoders' resolution and the following error of a standing axis.
constexpr double kArrivedMm = 0.02;
// No sample of a scan may lie farther from its planned position (recorded_machine.h knows the same bound).
constexpr double kFarthestSampleMm = 0.1;
// "Stands still": no axis moves more than this (mm, degrees) in 20 servo periods.
constexpr double kStandstill = 1e-4;

AxisPositions tightest(const AxisPositions& a, const AxisPositions& b, double (*choose)(double, double)) {
  return {choose(a.x_mm, b.x_mm), choose(a.y_mm, b.y_mm), choose(a.z_mm, b.z_mm),
          choose(a.theta_rad, b.theta_rad)};
}

// After these nobody knows what the machine does.
bool is_out_of_sight(const MachineFault& fault) {
  return fault.kind() == Kind::connection || fault.kind() == Kind::protocol;
}

bool is_secret_word(const std::string& word) {
  return !word.empty() && word.size() <= 64 &&
         std::all_of(word.begin(), word.end(),
                     [](unsigned char letter) { return letter > 0x20 && letter < 0x7f; });
}

}  // namespace

void LinuxCncSettings::validate() const {
  const auto require = [](bool holds, const char* field, const std::string& constraint) {
    if (!holds) throw InputError(fmt::format("{} must be {}", field, constraint));
  };
  require(!commands.host.empty(), "host", "a name or an address");
  require(is_secret_word(commands.connect_password), "connect_password", "1 to 64 letters without spaces");
  require(is_secret_word(commands.enable_password), "enable_password", "1 to 64 letters without spaces");
  require(commands.timeout_s >= 0.1 && commands.timeout_s <= 600.0, "timeout_s", "within 0.1 and 600");
  require(home_timeout_s >= 0.1 && home_timeout_s <= 3600.0, "home_timeout_s", "within 0.1 and 3600");
  require(sensor_timeout_s >= 0.01 && sensor_timeout_s <= 600.0, "sensor_timeout_s", "within 0.01 and 600");
  require(scan_speed_mm_per_s > 0.0 && scan_speed_mm_per_s <= 1000.0, "scan_speed_mm_per_s",
          "above 0 and at most 1000");
}

LinuxCncMachine::LinuxCncMachine(const LinuxCncSettings& settings, const AxisLimits& travel,
                                 const AxisDynamics& dynamics)
    : settings_(settings), travel_(travel), dynamics_(dynamics) {
  settings_.validate();
  dynamics_.validate();
}

LinuxCncMachine::~LinuxCncMachine() = default;

void LinuxCncMachine::connect() {
  samples_.reset();
  commands_.reset();
  // First the samples, of which there is one driver at a time: who is refused has not taken linuxcncrsh's
  // commands away from the driver that measures.
  samples_ = std::make_unique<SampleStream>(settings_.commands.host, settings_.sample_port,
                                            settings_.commands.timeout_s);
  // A controller that is slow to answer is no reason to take the program for dead.
  commands_ = std::make_unique<RshClient>(settings_.commands, [this] { samples_->keep_watch(); });
  const std::string linear = commands_->get("user_linear_units").text;
  const std::string angular = commands_->get("user_angular_units").text;
  if (linear != "MM" || angular != "DEG")
    throw MachineFault(Kind::protocol,
                       fmt::format("the controller counts in {} and {}, must be MM and DEG (LINEAR_UNITS and "
                                   "ANGULAR_UNITS in its INI file)",
                                   linear, angular));
  commands_->take_errors();  // of whatever happened before
  mode_.clear();
  stop_asked_ = false;
  samples_->present();
  const bool is_on = commands_->get("machine").text == "ON";
  state_ = is_on && is_homed() ? MachineState::idle : MachineState::not_homed;
}

bool LinuxCncMachine::is_homed() {
  const RshReply homed = commands_->get("joint_homed");
  if (homed.words.size() < 4) throw MachineFault(Kind::protocol, "the controller has fewer than four joints");
  return std::all_of(homed.words.begin(), homed.words.begin() + 4,
                     [](const std::string& word) { return word == "YES"; });
}

void LinuxCncMachine::require_set(const std::string& command) {
  if (!commands_->set(command)) fail_with_reason(fmt::format("the controller refused \"set {}\"", command));
}

void LinuxCncMachine::set_mode(const std::string& mode) {
  if (mode_ == mode) return;
  mode_.clear();
  require_set("mode " + mode);
  const auto start = Clock::now();
  while (commands_->get("mode").text != (mode == "manual" ? "MANUAL" : "AUTO")) {
    if (seconds_since(start) > settings_.commands.timeout_s)
      fail_with_reason(fmt::format("the controller does not change to {} mode", mode));
    std::this_thread::sleep_for(std::chrono::duration<double>(kStatusIntervalS));
  }
  mode_ = mode;
}

// Holds the feed, then collects the controller's own words and finds the kind of the fault in them.
void LinuxCncMachine::fail_with_reason(const std::string& what, Kind unexplained) {
  samples_->hold();
  const auto start = Clock::now();
  Kind kind = unexplained;
  std::string words;
  for (;;) {
    const bool in_estop = commands_->get("estop").text == "ON";
    const std::string limits = commands_->get("joint_limit").text;
    const std::string faults = commands_->get("joint_fault").text;
    if (const std::string more = commands_->take_errors(); !more.empty())
      words += (words.empty() ? "" : "; ") + more;
    const auto says = [&](const char* word) { return words.find(word) != std::string::npos; };
    if (in_estop)
      kind = Kind::emergency_stop;
    else if (faults.find("FAULT") != std::string::npos || says("following error"))
      kind = Kind::following_error;
    else if (limits.find("SOFT") != std::string::npos || limits.find("HARD") != std::string::npos ||
             says("limit"))
      kind = Kind::limit;
    else if (!is_homed())
      kind = Kind::not_homed;
    if (in_estop) words = words.empty() ? "e-stop" : "e-stop; " + words;
    if (!words.empty() || seconds_since(start) > kWordsTimeoutS) break;
    std::this_thread::sleep_for(std::chrono::duration<double>(kStatusIntervalS));
  }
  throw MachineFault(kind, words.empty() ? what : fmt::format("{}; the controller says: {}", what, words));
}

void LinuxCncMachine::home() {
  if (!commands_) throw MachineFault(Kind::connection, "the machine is not connected");
  stop_asked_ = false;
  state_ = MachineState::not_homed;
  try {
    switch_on();
    if (is_homed()) {
      state_ = MachineState::idle;
      return;
    }
  } catch (const MachineFault& fault) {
    if (is_out_of_sight(fault)) state_ = MachineState::unknown;
    throw;
  }
  move_watched([&] {
    set_mode("manual");
    samples_->start_samples();
    samples_->set_watch();
    state_ = MachineState::moving;
    require_set("home -1");
    follow_homing();
  });
}

void LinuxCncMachine::move_watched(const std::function<void()>& motion) {
  try {
    motion();
    samples_->release_watch();
    samples_->stop_samples();
  } catch (...) {
    end_motion();
    throw;
  }
  state_ = MachineState::idle;
}

void LinuxCncMachine::switch_on() {
  if (commands_->get("estop").text == "ON") {
    if (!settings_.reset_estop)
      throw MachineFault(Kind::emergency_stop,
                         "the controller is in e-stop: reset it at the machine, or let the program do so "
                         "(reset_estop in the machine file, --reset-estop)");
    require_set("estop off");
  }
  if (settings_.reset_estop) require_set("machine on");
  const auto start = Clock::now();
  // The controller takes up to a servo period and a task cycle to switch on.
  while (commands_->get("machine").text != "ON") {
    if (seconds_since(start) > settings_.commands.timeout_s)
      fail_with_reason("the machine is not switched on");
    std::this_thread::sleep_for(std::chrono::duration<double>(kStatusIntervalS));
  }
}

void LinuxCncMachine::follow_homing() {
  const auto start = Clock::now();
  for (;;) {
    // Reading the samples gives the signs of life, and tells when they came too late; all that have come are
    // read before the controller is asked, which has no better reason to give.
    const auto asked = Clock::now();
    while (samples_->next(std::max(0.0, kStatusIntervalS - seconds_since(asked)))) {
    }
    if (is_homed()) return;
    if (must_stop()) throw MachineFault(Kind::interrupted, "stopped while homing");
    if (commands_->get("machine").text != "ON") fail_with_reason("the machine went off while homing");
    if (seconds_since(start) > settings_.home_timeout_s)
      fail_with_reason(fmt::format("not homed within {} s", settings_.home_timeout_s));
  }
}

void LinuxCncMachine::require_ready() const {
  switch (state_.load()) {
    case MachineState::idle:
      return;
    case MachineState::disconnected:
      throw MachineFault(Kind::connection, "the machine is not connected");
    case MachineState::not_homed:
      throw MachineFault(Kind::not_homed, "the machine is not homed");
    default:
      throw MachineFault(Kind::interrupted, "the machine was stopped: connect and home it to go on");
  }
}

AxisLimits LinuxCncMachine::limits() const {
  if (!samples_) return travel_;
  const AxisLimits& controller = samples_->greeting().limits;
  return {tightest(travel_.lower, controller.lower, [](double a, double b) { return std::max(a, b); }),
          tightest(travel_.upper, controller.upper, [](double a, double b) { return std::min(a, b); })};
}

void LinuxCncMachine::require_within_limits(std::span<const AxisPositions> way) const {
  const AxisLimits allowed = limits();
  for (const AxisPositions& at : way)
    if (!allowed.contains(at))
      throw MachineFault(
          Kind::limit,
          fmt::format("target x {:.3f} y {:.3f} z {:.3f} mm theta {:.5f} rad is beyond the limits", at.x_mm,
                      at.y_mm, at.z_mm, at.theta_rad));
}

AxisPositions LinuxCncMachine::position() const {
  if (!samples_) throw MachineFault(Kind::connection, "the machine is not connected");
  try {
    return axis_positions(samples_->present());
  } catch (const MachineFault&) {
    state_ = MachineState::unknown;
    throw;
  }
}

void LinuxCncMachine::run_program(const Motion& motion, const std::function<bool(const LatchedSample&)>& use,
                                  const std::function<bool()>& done) {
  require_ready();
  move_watched([&] {
    set_mode("auto");
    samples_->store_program(motion.program);
    samples_->start_samples();
    require_set("open " + samples_->greeting().program_file);
    samples_->set_watch();
    state_ = MachineState::moving;
    require_set("run");
    follow_program(motion, use, done);
  });
}

void LinuxCncMachine::follow_program(const Motion& motion,
                                     const std::function<bool(const LatchedSample&)>& use,
                                     const std::function<bool()>& done) {
  const auto start = Clock::now();
  auto last_status = start;
  auto last_news = start;
  std::optional<LatchedSample> before;
  std::optional<Clock::time_point> idle_since;
  bool seen_running = false;
  // Every sample passes here, also those that arrive after the program has ended.
  const auto see = [&](const LatchedSample& sample) {
    if (!sample.motion_enabled) fail_with_reason("the controller has switched the axes off");
    const bool is_new = !before || before->reading != sample.reading;
    if (is_new || (!motion.needs_readings && before->axes != sample.axes)) last_news = Clock::now();
    before = sample;
    return use(sample);
  };
  for (;;) {
    if (must_stop()) throw MachineFault(Kind::interrupted, "the machine was stopped");
    const auto sample = samples_->next(kStatusIntervalS);
    if (sample && !see(*sample)) throw MachineFault(Kind::interrupted, "the scan was broken off");
    if (!done() && seconds_since(last_news) > settings_.sensor_timeout_s)
      throw MachineFault(Kind::sensor, fmt::format("the sensor is silent: no new reading for {} s",
                                                   settings_.sensor_timeout_s));
    // Counted from the last answer, so that late answers leave time to read the samples that came meanwhile.
    if (seconds_since(last_status) < kStatusIntervalS) continue;
    const std::string status = commands_->get("program_status").text;
    last_status = Clock::now();
    if (status != "IDLE") {
      seen_running = true;
      idle_since.reset();
    } else {
      if (done()) return;
      // A program that has not begun by then was refused, as one that leaves the limits is.
      if (!idle_since && (seen_running || seconds_since(start) > kStartTimeoutS)) idle_since = last_status;
      // Samples under way may still say that it came to its end.
      if (idle_since && seconds_since(*idle_since) > settings_.sensor_timeout_s)
        fail_with_reason("the controller did not carry the program out to its end");
    }
    if (seconds_since(start) > motion.longest_s)
      fail_with_reason(fmt::format("the motion has not ended within {:.0f} s", motion.longest_s));
  }
}

void LinuxCncMachine::move_to(const AxisPositions& target) {
  move_through({&target, 1});
}

void LinuxCncMachine::move_through(std::span<const AxisPositions> way) {
  require_ready();
  require_within_limits(way);
  if (way.empty()) return;
  AxisPositions at = position();
  if (way.size() == 1 && distance_between(at, way.front()) < 1e-6) return;
  double estimate_s = 0.0;
  for (const AxisPositions& next : way) {
    estimate_s += move_time_s(dynamics_, at, next);
    at = next;
  }
  // The program is at its end when the axes stand at the last position and the program says so by running
  // no line any more.
  bool arrived = false;
  run_program(
      {.program = move_program(way),
       .longest_s = 3.0 * estimate_s + kProgramOverheadS,
       .needs_readings = false},
      [&](const LatchedSample& sample) {
        arrived = distance_between(axis_positions(sample), way.back()) < kArrivedMm;
        return true;
      },
      [&] { return arrived; });
}

ProbeSample LinuxCncMachine::measure_point() {
  const double number = static_cast<double>(point_);
  std::optional<LatchedSample> measured;
  std::optional<std::uint32_t> reading;
  run_program(
      {.program = point_program(point_), .longest_s = kProgramOverheadS},
      [&](const LatchedSample& sample) {
        if (sample.first_point == number && !measured && reading != sample.reading) measured = sample;
        reading = sample.reading;
        return true;
      },
      [&] { return measured.has_value(); });
  ++point_;
  return probe_sample(*measured, samples_->greeting().servo_period_s);
}

std::size_t LinuxCncMachine::scan_line(std::span<const AxisPositions> path, const SampleSink& sink) {
  require_ready();
  require_within_limits(path);
  if (path.empty()) return 0;
  const double period_s = samples_->greeting().servo_period_s;
  const std::string program = scan_program(path, point_, line_, {period_s, settings_.scan_speed_mm_per_s});
  double estimate_s = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k)
    estimate_s += distance_between(path[k - 1], path[k]) / settings_.scan_speed_mm_per_s +
                  move_time_s(dynamics_, path[k - 1], path[k]);

  SamplePicker picker(path, point_);
  std::size_t delivered = 0;
  const SamplePicker::Pick deliver = [&](std::size_t position, const LatchedSample& latched) {
    const double off_mm = distance_between(axis_positions(latched), path[position]);
    if (off_mm > kFarthestSampleMm)
      fail_with_reason(
          fmt::format(
              "the nearest reading to position {} of the line was taken {:.3f} mm from it, must be within "
              "{} mm: the sensor gave none there, or an axis does not follow",
              position + 1, off_mm, kFarthestSampleMm),
          Kind::sensor);
    ++delivered;
    return sink(probe_sample(latched, period_s));
  };
  ++line_;
  const std::uint64_t first_point = point_;
  bool broken_off = false;
  try {
    run_program(
        {.program = program, .longest_s = 3.0 * estimate_s + kProgramOverheadS},
        [&](const LatchedSample& sample) {
          if (picker.take(sample, deliver)) return true;
          broken_off = true;
          return false;
        },
        [&] { return picker.finished(); });
  } catch (const MachineFault&) {
    point_ = first_point + delivered;
    if (!broken_off) throw;
  }
  point_ = first_point + delivered;
  return delivered;
}

void LinuxCncMachine::skip_measured(const MeasuredBefore& before) {
  line_ += before.lines;
  point_ += before.samples;
}

bool LinuxCncMachine::stands_still() {
  const auto start = Clock::now();
  std::optional<LatchedSample> reference;
  while (seconds_since(start) < settings_.commands.timeout_s) {
    const auto sample = samples_->next(kStatusIntervalS);
    if (!sample) continue;
    if (!reference) reference = sample;
    double travel = 0.0;
    for (std::size_t k = 0; k < 4; ++k)
      travel = std::max(travel, std::abs(sample->axes[k] - reference->axes[k]));
    if (travel > kStandstill) reference = sample;
    if (sample->sequence - reference->sequence >= 20) return true;
  }
  return false;
}

void LinuxCncMachine::end_motion() noexcept {
  MachineState state = MachineState::unknown;
  if (samples_) samples_->hold();
  // The hold alone ends motion; the abort throws the rest of the program away. Each may fail with its
  // connection, and the other still counts.
  try {
    if (commands_) commands_->set("abort");
  } catch (const std::exception&) {
  }
  try {
    if (samples_) {
      samples_->start_samples();
      if (stands_still()) state = MachineState::stopped;
      samples_->stop_samples();
    }
  } catch (const std::exception&) {
  }
  mode_.clear();
  state_ = state;
}

bool LinuxCncMachine::must_stop() const {
  return stop_asked_ || (stop_when_ && stop_when_());
}

void LinuxCncMachine::stop() noexcept {
  stop_asked_ = true;
  if (state_ == MachineState::moving && samples_) samples_->hold();
  if (state_ == MachineState::idle) state_ = MachineState::stopped;
}

std::string LinuxCncMachine::status_words() {
  const std::string errors = commands_->take_errors();
  return fmt::format("e-stop {}, power {}, homed {}, limits {}, faults {}{}", commands_->get("estop").text,
                     commands_->get("machine").text, commands_->get("joint_homed").text,
                     commands_->get("joint_limit").text, commands_->get("joint_fault").text,
                     errors.empty() ? "" : "; the controller says: " + errors);
}

}  // namespace trueblade
