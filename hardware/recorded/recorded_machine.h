// The recorded backend: replays a journal through the interface of the machine that it was measured with.
// Nothing moves.
#pragma once

#include "hardware/machine_driver.h"
#include "hardware/recorded/journal.h"

namespace trueblade {

class RecordedMachine final : public MachineDriver {
 public:
  // `name` stands for the journal in messages; `limits` are those of the machine that measured.
  RecordedMachine(Journal journal, std::string name, const AxisLimits& limits);

  void connect() override;
  void home() override;
  void move_to(const AxisPositions& target) override;
  ProbeSample measure_point() override;
  // Delivers the next samples of the journal. Throws MachineFault: (protocol) when one was taken elsewhere
  // than the path says, that is, when the journal belongs to another plan; (sensor) when the journal ends.
  std::size_t scan_line(std::span<const AxisPositions> path, const SampleSink& sink) override;
  void skip_measured(const MeasuredBefore& before) override;
  void stop() noexcept override;
  MachineState state() const override { return state_; }
  AxisPositions position() const override { return at_; }
  AxisLimits limits() const override { return limits_; }

 private:
  const ProbeSample& next_sample();

  std::string name_;
  AxisLimits limits_;
  std::vector<ProbeSample> samples_;
  std::size_t next_ = 0;
  AxisPositions at_;
  MachineState state_ = MachineState::disconnected;
};

}  // namespace trueblade
