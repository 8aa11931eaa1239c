#include "hardware/linuxcnc/hal_door.h"

#include <array>
#include <stdexcept>

#define ULAPI
extern "C++" {
#include <linuxcnc/hal.h>
}

namespace trueblade {
namespace {

// Where sampler and streamer keep their streams: the keys of LinuxCNC's sampler.h and streamer.h, which the
// headers package does not carry.
constexpr int kSamplerKey = 0x48534130;
constexpr int kStreamerKey = 0x48535430;

void require(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error(what);
}

template <class Pin>
Pin** new_pin() {
  void* memory = hal_malloc(sizeof(Pin*));
  require(memory != nullptr, "HAL has no shared memory left");
  return static_cast<Pin**>(memory);
}

hal_bit_t** new_bit(const HalComponent& component, const std::string& name, hal_pin_dir_t direction) {
  hal_bit_t** pin = new_pin<hal_bit_t>();
  require(hal_pin_bit_new((component.name() + "." + name).c_str(), direction, pin, component.id()) == 0,
          "HAL does not take the pin " + name);
  return pin;
}

}  // namespace

HalComponent::HalComponent(const std::string& name) : name_(name), id_(hal_init(name.c_str())) {
  require(id_ > 0, "no HAL is running, or it has a component " + name + " already");
}

HalComponent::~HalComponent() {
  hal_exit(id_);
}

void HalComponent::ready() {
  require(hal_ready(id_) == 0, "HAL does not take the component as ready");
}

HalBitOut::HalBitOut(const HalComponent& component, const std::string& name)
    : pin_(new_bit(component, name, HAL_OUT)) {}

void HalBitOut::set(bool value) {
  **static_cast<hal_bit_t**>(pin_) = value;
}

HalBitIn::HalBitIn(const HalComponent& component, const std::string& name)
    : pin_(new_bit(component, name, HAL_IN)) {}

bool HalBitIn::get() const {
  return **static_cast<hal_bit_t**>(pin_);
}

HalCountOut::HalCountOut(const HalComponent& component, const std::string& name) {
  hal_u32_t** pin = new_pin<hal_u32_t>();
  require(hal_pin_u32_new((component.name() + "." + name).c_str(), HAL_OUT, pin, component.id()) == 0,
          "HAL does not take the pin " + name);
  pin_ = pin;
}

void HalCountOut::set(std::uint32_t value) {
  **static_cast<hal_u32_t**>(pin_) = value;
}

struct HalStream::Attached {
  hal_stream_t stream{};
};

HalStream::HalStream(const HalComponent& component, End end, int channel, const std::string& fields)
    : attached_(new Attached), fields_(fields) {
  const int key = (end == End::sampler ? kSamplerKey : kStreamerKey) + channel;
  require(fields.size() <= HAL_STREAM_MAX_PINS, "too many fields for a stream");
  require(hal_stream_attach(&attached_->stream, component.id(), key, fields.c_str()) == 0,
          "no " + std::string(end == End::sampler ? "sampler" : "streamer") + " channel " +
              std::to_string(channel) + " with cfg=" + fields + " is loaded");
}

HalStream::~HalStream() {
  hal_stream_detach(&attached_->stream);
}

std::optional<HalStream::Record> HalStream::read() {
  if (!hal_stream_readable(&attached_->stream)) return std::nullopt;
  std::array<hal_stream_data, HAL_STREAM_MAX_PINS> raw{};
  unsigned number = 0;
  if (hal_stream_read(&attached_->stream, raw.data(), &number) != 0) return std::nullopt;
  // The stream numbers the records that found a place; what found none left a gap.
  number += static_cast<unsigned>(hal_stream_num_overruns(&attached_->stream));
  Record record{number, std::vector<HalValue>(fields_.size())};
  for (std::size_t k = 0; k < fields_.size(); ++k) switch (fields_[k]) {
      case 'f':
        record.values[k].f = raw[k].f;
        break;
      case 's':
        record.values[k].s = raw[k].s;
        break;
      case 'u':
        record.values[k].u = raw[k].u;
        break;
      default:
        record.values[k].b = raw[k].b;
    }
  return record;
}

int HalStream::waiting() const {
  return hal_stream_depth(&attached_->stream);
}

bool HalStream::write(const std::vector<HalValue>& values) {
  require(values.size() == fields_.size(), "a record has another number of fields than its stream");
  if (!hal_stream_writable(&attached_->stream)) return false;
  std::array<hal_stream_data, HAL_STREAM_MAX_PINS> raw{};
  for (std::size_t k = 0; k < values.size(); ++k) switch (fields_[k]) {
      case 'f':
        raw[k].f = values[k].f;
        break;
      case 's':
        raw[k].s = values[k].s;
        break;
      case 'u':
        raw[k].u = values[k].u;
        break;
      default:
        raw[k].b = values[k].b;
    }
  return hal_stream_write(&attached_->stream, raw.data()) == 0;
}

}  // namespace trueblade
