// trueblade-virtual-probe: hardware in the loop. It takes the axis positions that the controller's `sampler`
// latched, casts the beam of a scenario's virtual machine on its virtual part from exactly there, and puts
// distance, SNR and flags back into HAL through `streamer`, together with the positions that they belong to.
// Controller and motion are real; part, sensor and errors are those of the simulated backend, with the same
// draws for the same points.
//
//   loadusr -W trueblade-virtual-probe SCENARIO.yaml
#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "apps/measure.h"
#include "geometry/error.h"
#include "hardware/linuxcnc/hal_records.h"
#include "hardware/linuxcnc/scan_program.h"
#include "sim/latched_probe.h"

namespace trueblade {
namespace {

std::atomic<bool> ended = false;
extern "C" void note_end(int) {
  ended = true;
}

// `streamer` hands out one reading a servo period. Those that piled up while the computer was busy would
// delay all that follow, for good; so between lines, where none is needed, new ones are left out until few
// wait.
constexpr int kMostWaiting = 5;

void answer_triggers(HalStream& triggers, HalStream& readings, LatchedProbe& probe, double servo_period_s) {
  std::uint32_t number = 0;
  while (!ended) {
    const auto trigger = triggers.read();
    if (!trigger) {
      // A quarter of a servo period: what has piled up meanwhile is answered at once.
      std::this_thread::sleep_for(std::chrono::microseconds(250));
      continue;
    }
    const std::vector<HalValue>& v = trigger->values;
    if (v[4].f < 0.0 && readings.waiting() > kMostWaiting) continue;
    LatchedProbe::Trigger at;
    LatchedSample latched;
    latched.axes = {v[0].f, v[1].f, v[2].f, v[3].f};
    at.axes = axis_positions(latched);
    at.time_s = servo_period_s * trigger->number;
    if (v[4].f >= 0.0) {
      at.first_point = static_cast<std::uint64_t>(v[4].f);
      at.line = static_cast<std::uint64_t>(v[5].f);
      if (v[6].s >= kFirstPointLine) at.position = static_cast<std::uint64_t>(v[6].s - kFirstPointLine);
    }
    const ProbeSample sample = probe.measure(at);

    std::vector<HalValue> reading(std::char_traits<char>::length(kReadingFields));
    for (std::size_t k = 0; k < 5; ++k) reading[k].f = v[k].f;
    reading[5].s = v[6].s;
    reading[6].f = sample.distance_mm;
    reading[7].f = sample.snr;
    reading[8].u = sample.flags.bits();
    reading[9].u = ++number;
    reading[10].b = sample.flags.usable();
    while (!ended && !readings.write(reading)) std::this_thread::sleep_for(std::chrono::microseconds(250));
  }
}

int run(int argument_count, char** arguments) {
  std::string file;
  double servo_period_s = 0.001;
  CLI::App app("Answers for the probe of a LinuxCNC machine with a virtual part.", "trueblade-virtual-probe");
  app.add_option("scenario", file, "Scenario file (YAML): part, machine, errors, seed")->required();
  app.add_option("--servo-period", servo_period_s, "Of the servo thread, in seconds");
  CLI11_PARSE(app, argument_count, arguments);
  std::signal(SIGINT, note_end);
  std::signal(SIGTERM, note_end);
  try {
    const Scenario scenario = read_scenario(file);
    const PartOnMachine nominal = put_on_machine(make_part(scenario.part));
    LatchedProbe probe(virtual_part(scenario, nominal), virtual_setup(scenario));
    HalComponent component("trueblade-virtual-probe");
    HalStream triggers(component, HalStream::End::sampler, kTriggerChannel, kTriggerFields);
    HalStream readings(component, HalStream::End::streamer, kReadingChannel, kReadingFields);
    component.ready();
    answer_triggers(triggers, readings, probe, servo_period_s);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "trueblade-virtual-probe: %s\n", failure.what());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace trueblade

int main(int argument_count, char** arguments) {
  return trueblade::run(argument_count, arguments);
}
