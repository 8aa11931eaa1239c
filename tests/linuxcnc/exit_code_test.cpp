// What a user of the command sees of a fault: exit code 3, its words, and how it leaves the machine.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/apps/child_process.h"
#include "tests/linuxcnc/scripted_controller.h"

namespace trueblade {
namespace {

constexpr int kMachineFault = 3;

std::string machine_text(const ScriptedController& controller) {
  const LinuxCncSettings settings = controller.settings();
  return fmt::format(
      "{{backend: linuxcnc, controller: {{command_port: {}, sample_port: {}, timeout_s: 0.5, "
      "sensor_timeout_s: "
      "0.5, reset_estop: true}}}}\n",
      settings.commands.port, settings.sample_port);
}

void expect_fault(const ChildResult& ended, const std::string& state) {
  EXPECT_EQ(ended.exit_code, kMachineFault) << ended.ended_by << ": " << ended.err;
  EXPECT_NE(ended.err.find("machine fault: "), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("the machine is " + state), std::string::npos) << ended.err;
}

TEST(LinuxCncExitCode, AMachineCommandThatIsCutOff) {
  const ScratchFolder folder;
  Misbehaviour misbehaviour;
  misbehaviour.homing_periods = 100'000;
  misbehaviour.samples = [](std::size_t, const LatchedSample&) { return std::nullopt; };
  misbehaviour.replies = [](std::size_t n, const std::string& reply) {
    return n < 30 ? std::optional(reply) : std::nullopt;
  };
  ScriptedController controller(misbehaviour);
  const auto machine = folder.write("machine.yaml", machine_text(controller));
  expect_fault(run_trueblade({"machine", "home", "--machine", machine.string()}), "stopped");
  EXPECT_TRUE(controller.was_held());
}

TEST(LinuxCncExitCode, AScanWhoseSamplesAreCutOff) {
  const ScratchFolder folder;
  Misbehaviour misbehaviour;
  misbehaviour.samples = [](std::size_t n, const LatchedSample& sample) -> std::optional<std::string> {
    if (n > 12 && sample.first_point >= 0.0) return std::nullopt;
    return frame_bytes(StreamFrame::Type::sample, sample_payload(sample));
  };
  ScriptedController controller(misbehaviour);
  folder.write("sphere.yaml", "name: cut_off\npart: {demonstration: reference_sphere}\nmachine: " +
                                  machine_text(controller) +
                                  "scan: {views: [{name: front, theta_deg: 0}], spacing_mm: 3}\n");
  const ChildResult ended = run_trueblade({"scan", "sphere.yaml", "--out", "sphere.ply"}, folder.path());
  expect_fault(ended, "unknown");
  EXPECT_NE(ended.err.find("--resume goes on"), std::string::npos) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "sphere.journal"));
}

TEST(LinuxCncExitCode, ControlCWhileHoming) {
  const ScratchFolder folder;
  Misbehaviour misbehaviour;
  misbehaviour.homing_periods = 100'000;
  ScriptedController controller(misbehaviour);
  const auto machine = folder.write("machine.yaml", machine_text(controller));
  ChildOptions options;
  options.interrupt_when = [&] { return controller.was_watched(); };
  const ChildResult ended =
      run_trueblade({"machine", "home", "--machine", machine.string()}, folder.path(), options);
  EXPECT_EQ(ended.exit_code, 130) << ended.err;
  EXPECT_NE(ended.err.find("the machine is stopped"), std::string::npos) << ended.err;
  EXPECT_TRUE(controller.was_held());
  EXPECT_TRUE(controller.was_aborted());
}

}  // namespace
}  // namespace trueblade
