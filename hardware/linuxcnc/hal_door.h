// LinuxCNC's hardware abstraction layer (HAL) behind one door: a userspace component with its pins, and the
// shared-memory streams of the stock realtime components `sampler` and `streamer`.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace trueblade {

// One field of a record, by the letter of its stream: f float, s s32, u u32, b bit.
struct HalValue {
  double f = 0.0;
  std::int32_t s = 0;
  std::uint32_t u = 0;
  bool b = false;
};

class HalComponent {
 public:
  // Throws std::runtime_error when no HAL is there or the name is taken.
  explicit HalComponent(const std::string& name);
  ~HalComponent();
  HalComponent(const HalComponent&) = delete;
  HalComponent& operator=(const HalComponent&) = delete;

  int id() const { return id_; }
  const std::string& name() const { return name_; }
  void ready();

 private:
  std::string name_;
  int id_;
};

class HalBitOut {
 public:
  HalBitOut(const HalComponent& component, const std::string& name);  // before ready()
  void set(bool value);

 private:
  void* pin_;  // in HAL's shared memory, which outlives the program
};

class HalBitIn {
 public:
  HalBitIn(const HalComponent& component, const std::string& name);  // before ready()
  bool get() const;                                                  // false where nothing is connected

 private:
  void* pin_;
};

class HalCountOut {
 public:
  HalCountOut(const HalComponent& component, const std::string& name);
  void set(std::uint32_t value);

 private:
  void* pin_;
};

// The reading end of `sampler` channel `channel`, or the writing end of `streamer` channel `channel`;
// `fields` is the channel's cfg string.
class HalStream {
 public:
  enum class End { sampler, streamer };
  HalStream(const HalComponent& component, End end, int channel, const std::string& fields);
  ~HalStream();
  HalStream(const HalStream&) = delete;
  HalStream& operator=(const HalStream&) = delete;

  struct Record {
    std::uint32_t
        number;  // of the servo period; also those count whose record was lost as the stream was full
    std::vector<HalValue> values;
  };
  std::optional<Record> read();                     // nullopt: nothing there
  bool write(const std::vector<HalValue>& values);  // false: full
  int waiting() const;                              // records written and not yet read

 private:
  struct Attached;
  std::unique_ptr<Attached> attached_;
  std::string fields_;
};

}  // namespace trueblade
