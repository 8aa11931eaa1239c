#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "apps/calibrate_machine.h"
#include "apps/command_machine.h"
#include "apps/console.h"
#include "apps/interrupt.h"
#include "apps/machine_fields.h"
#include "apps/on_machine.h"
#include "geometry/atomic_file.h"
#include "geometry/error.h"
#include "hardware/linuxcnc/linuxcnc_machine.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct MachineOptions {
  std::string file;
  bool reset_estop = false;
  std::string axis;      // jog
  double by = 0.0;       // jog, mm or degrees
  double seconds = 1.0;  // record
  std::string out;       // record
};

MachineSpec real_machine(const std::string& file) {
  MachineSpec machine = read_machine(file);
  if (machine.backend != "linuxcnc")
    throw file_error(file, fmt::format("backend is {}, must be linuxcnc for this command", machine.backend));
  return machine;
}

MachineSpec spec_of(const MachineOptions& options) {
  MachineSpec spec = real_machine(options.file);
  if (options.reset_estop) spec.linuxcnc.reset_estop = true;
  return spec;
}

nlohmann::ordered_json json_of(const AxisPositions& at) {
  return {{"x_mm", at.x_mm}, {"y_mm", at.y_mm}, {"z_mm", at.z_mm}, {"theta_deg", at.theta_rad / kDegree}};
}

std::string words_for(const AxisPositions& at) {
  return fmt::format("x {:.4f}  y {:.4f}  z {:.4f} mm  theta {:.5f} deg", at.x_mm, at.y_mm, at.z_mm,
                     at.theta_rad / kDegree);
}

void show_status(LinuxCncMachine& machine, bool json) {
  const std::string controller = machine.status_words();
  const AxisPositions at = machine.position();
  const AxisLimits limits = machine.limits();
  const StreamGreeting& stream = machine.stream_facts();
  if (json) {
    fmt::print(
        "{}\n",
        nlohmann::ordered_json{{"state", to_string(machine.state())},
                               {"controller", controller},
                               {"position", json_of(at)},
                               {"limits", {{"from", json_of(limits.lower)}, {"to", json_of(limits.upper)}}},
                               {"servo_period_s", stream.servo_period_s}}
            .dump(2));
    return;
  }
  fmt::print(
      "machine     {}\ncontroller  {}\nposition    {}\nlimits      from {}\n            to   {}\nservo       "
      "{} s\n",
      to_string(machine.state()), controller, words_for(at), words_for(limits.lower), words_for(limits.upper),
      stream.servo_period_s);
}

void home(LinuxCncMachine& machine) {
  machine.home();
  fmt::print("homed, at {}\n", words_for(machine.position()));
}

void jog(LinuxCncMachine& machine, const MachineOptions& options) {
  if (!std::isfinite(options.by))
    throw InputError(fmt::format("--by is {}, must be a finite number", options.by));
  AxisPositions target = machine.position();
  if (options.axis == "x") target.x_mm += options.by;
  if (options.axis == "y") target.y_mm += options.by;
  if (options.axis == "z") target.z_mm += options.by;
  if (options.axis == "theta") target.theta_rad += options.by * kDegree;
  machine.move_to(target);
  fmt::print("at {}\n", words_for(machine.position()));
}

void measure(LinuxCncMachine& machine, bool json) {
  const ProbeSample sample = machine.measure_point();
  if (json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"position", json_of(sample.axes)},
                                              {"distance_mm", sample.distance_mm},
                                              {"snr", sample.snr},
                                              {"usable", sample.flags.usable()},
                                              {"flags", sample.flags.bits()}}
                           .dump(2));
  } else {
    fmt::print("at {}\n", words_for(sample.axes));
    if (sample.flags.usable())
      fmt::print("distance {:.4f} mm, SNR {:.3f}\n", sample.distance_mm, sample.snr);
    else
      fmt::print("no distance: {}\n", sample.flags.out_of_range ? "out of range" : "no return");
  }
}

// Every servo period as it comes, whatever moves: the encoders and the sensor as they are.
int record(const MachineOptions& options) {
  const MachineSpec spec = real_machine(options.file);
  const RshAccess& access = spec.linuxcnc.commands;
  SampleStream samples(access.host, spec.linuxcnc.sample_port, access.timeout_s);
  const double period_s = samples.greeting().servo_period_s;
  const auto wanted = static_cast<std::size_t>(options.seconds / period_s + 0.5);
  std::size_t taken = 0, silent = 0;
  std::uint32_t reading = 0;
  Progress progress("record");
  const auto take_one = [&](std::ostream& out) {
    const auto sample = samples.next(access.timeout_s);
    if (!sample) throw MachineFault(MachineFault::Kind::sensor, "no sample came within the time");
    const auto& at = sample->axes;
    out << fmt::format("{:.4f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.4f},{},{}\n",
                       period_s * sample->sequence, at[0], at[1], at[2], at[3], sample->distance_mm,
                       sample->snr, sample->flags, sample->reading);
    if (taken > 0 && sample->reading == reading) ++silent;
    reading = sample->reading;
    ++taken;
    if (taken % 100 == 0) progress.report(taken, wanted);
  };
  std::optional<MachineFault> fault;  // what came before it is kept
  const auto start = std::chrono::steady_clock::now();
  write_file_atomically(options.out, [&](std::ostream& out) {
    out << "time_s,x_mm,y_mm,z_mm,theta_deg,distance_mm,snr,flags,reading\n";
    samples.start_samples();
    try {
      while (taken < wanted && !interrupted()) take_one(out);
    } catch (const MachineFault& failure) {
      fault = failure;
    }
  });
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (fault)
    throw MachineFault(fault->kind(), fmt::format("{}; the {} samples that came before are in {}",
                                                  fault->what(), taken, options.out));
  fmt::print("{} samples in {:.2f} s ({:.1f} a second), none lost, {} without a new reading -> {}\n", taken,
             took_s, static_cast<double>(taken) / took_s, silent, options.out);
  return ExitCode::done;
}

}  // namespace

void add_machine_command(CLI::App& app, CommandLine& line) {
  CLI::App* machine = app.add_subcommand(
      "machine", "Bring-up of a machine: status, home, jog, measure, record, calibrate, touch, locate");
  machine->require_subcommand(1);
  machine->footer(R"(
Examples:
  trueblade machine status --machine site.yaml
  trueblade machine home   --machine site.yaml --reset-estop
  trueblade machine jog    --machine site.yaml --axis x --by 5
  trueblade machine record --machine site.yaml --seconds 10 --out samples.csv
  trueblade machine calibrate scenarios/calibration_sphere.yaml --out geometry.yaml
  trueblade machine touch  --machine site.yaml --points points.yaml --name tip --part-mm 0 0 90
  trueblade machine locate --machine site.yaml --points points.yaml --out part.yaml

The machine file holds the keys of a scenario's machine block. Bring-up step by step: docs/linuxcnc.md)");
  auto options = std::make_shared<MachineOptions>();
  const auto add = [&](const char* name, const char* help, std::function<int()> work) {
    CLI::App* command = machine->add_subcommand(name, help);
    command->add_option("--machine", options->file, "Machine file (YAML)")->required()->type_name("FILE");
    command->add_flag(
        "--reset-estop", options->reset_estop,
        "Reset an e-stop and switch the machine on, instead of leaving that to someone at the machine");
    command->callback([work = std::move(work), &line] { line.chosen = work; });
    return command;
  };
  const auto with_machine = [options](std::function<void(LinuxCncMachine&)> work) {
    return [options, work = std::move(work)] {
      on_machine(spec_of(*options), work);
      return ExitCode::done;
    };
  };
  CLI::App* status = add("status", "State, position, limits, the controller's own words. Nothing moves",
                         with_machine([&line](auto& on) { show_status(on, line.json); }));
  status->add_flag("--json", line.json, "As JSON on standard output");
  add("home", "Home all axes", with_machine(home));
  CLI::App* jog_command =
      add("jog", "Move one axis by a distance", with_machine([options](auto& on) { jog(on, *options); }));
  jog_command->add_option("--axis", options->axis, "x, y, z or theta")
      ->required()
      ->check(CLI::IsMember({"x", "y", "z", "theta"}));
  jog_command->add_option("--by", options->by, "mm, or degrees for theta")->required()->type_name("DISTANCE");
  CLI::App* measure_command = add("measure", "One reading of the probe where it stands",
                                  with_machine([&line](auto& on) { measure(on, line.json); }));
  measure_command->add_flag("--json", line.json, "As JSON on standard output");
  CLI::App* record_command = add("record", "Every servo period's positions and reading as CSV. Nothing moves",
                                 [options] { return record(*options); });
  record_command->add_option("--seconds", options->seconds, "How long (default 1)")
      ->check(CLI::PositiveNumber);
  record_command->add_option("--out", options->out, "CSV file")->required()->type_name("FILE");
  add_calibration_commands(*machine, line);
}

}  // namespace trueblade
