// Latency of a stop on the running controller, for results/linuxcnc/README.md:
//
//   scripts/linuxcnc.sh start scenarios/turbine_blade_linuxcnc.yaml
//   halcmd unlinkp sampler.0.pin.0; halcmd linkps sampler.0.pin.0 x-encoder    # as the loop's user
//   build/release/bench/linuxcnc_stop
//   scripts/linuxcnc.sh stop
//
// (halcmd: the encoder is latched directly, as with a sensor card, not by way of the virtual probe.)
//
// The x axis runs at the scan's fastest speed; somewhere on its way the program asks for the stop (`hold`),
// or hangs, so that its signs of life stay out. Time and way are counted by the samples that the controller
// latched, from the last one that the program had seen when it asked (or hung) to the last one that moved.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "hardware/linuxcnc/linuxcnc_machine.h"

namespace {

using namespace trueblade;
using Clock = std::chrono::steady_clock;

constexpr double kSpeedMmPerS = 50.0;
constexpr double kAccelerationMmPerS2 = 500.0;  // of the INI file
constexpr int kStops = 20;

struct Stop {
  double time_s, way_mm;
};

// That the watchdog has ended motion is what is measured here.
LatchedSample next(SampleStream& samples) {
  for (;;) try {
      if (const auto sample = samples.next(1.0)) return *sample;
    } catch (const MachineFault& fault) {
      if (fault.kind() != MachineFault::Kind::interrupted) throw;
    }
}

void bring_to_start(const LinuxCncSettings& settings) {
  LinuxCncMachine machine(settings, {{-500, -500, -500, -100}, {500, 500, 500, 100}}, {});
  machine.connect();
  machine.home();
  machine.move_to({});
}

Stop stop_once(const LinuxCncSettings& settings, double at_mm, bool hang) {
  bring_to_start(settings);
  RshClient commands(settings.commands, [] {});
  SampleStream samples(settings.commands.host, settings.sample_port, settings.commands.timeout_s);
  commands.set("mode auto");
  while (commands.get("mode").text != "AUTO") std::this_thread::sleep_for(std::chrono::milliseconds(20));
  samples.store_program(fmt::format("G21 G90 G94 G61.1\nG53 G1 X200 F{}\nM2\n", 60.0 * kSpeedMmPerS));
  samples.start_samples();
  commands.set("open " + samples.greeting().program_file);
  samples.set_watch();
  commands.set("run");
  LatchedSample seen = next(samples);
  while (seen.axes[0] < at_mm) seen = next(samples);
  if (hang)
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  else
    samples.hold();
  LatchedSample moved = seen, last = seen;
  constexpr std::uint32_t kStanding = 50;  // servo periods
  while (last.sequence - moved.sequence < kStanding) {
    last = next(samples);
    if (std::abs(last.axes[0] - moved.axes[0]) > 1e-4) moved = last;
  }
  samples.hold();
  commands.set("abort");
  return {samples.greeting().servo_period_s * (moved.sequence - seen.sequence), moved.axes[0] - seen.axes[0]};
}

void report(const char* what, const LinuxCncSettings& settings, bool hang) {
  std::vector<double> times_s, ways_mm;
  for (int k = 0; k < kStops; ++k) {
    const Stop stop = stop_once(settings, 20.0 + 0.37 * k, hang);
    times_s.push_back(stop.time_s);
    ways_mm.push_back(stop.way_mm);
  }
  std::sort(times_s.begin(), times_s.end());
  std::sort(ways_mm.begin(), ways_mm.end());
  const std::size_t middle = kStops / 2;
  fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.2f} |\n", what, 1e3 * times_s.front(),
             1e3 * times_s[middle], 1e3 * times_s.back(), ways_mm[middle], ways_mm.back());
}

}  // namespace

int main() {
  LinuxCncSettings settings;
  settings.reset_estop = true;
  settings.commands.timeout_s = 30.0;  // a busy computer is no fault here
  fmt::print("{} stops each from {} mm/s; braking alone takes {:.0f} ms and {:.2f} mm\n\n", kStops,
             kSpeedMmPerS, 1e3 * kSpeedMmPerS / kAccelerationMmPerS2,
             kSpeedMmPerS * kSpeedMmPerS / (2.0 * kAccelerationMmPerS2));
  fmt::print("| | least ms | median ms | most ms | median mm | most mm |\n|---|---|---|---|---|---|\n");
  report("the program says hold", settings, false);
  report("the program hangs (watchdog 500 ms)", settings, true);
}
