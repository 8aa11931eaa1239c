// The fields of the records that pass through HAL's streams; the HAL files in config/ connect the pins in
// this order.
#pragma once

#include "hardware/linuxcnc/hal_door.h"
#include "hardware/linuxcnc/sample_frame.h"

namespace trueblade {

// sampler channel 0, to trueblade-hal: x y z c, first point, program line, distance, SNR, flags, reading,
// valid, motion enabled.
inline constexpr const char* kSampleFields = "fffffsffuubb";
inline constexpr int kSampleChannel = 0;

inline LatchedSample latched_sample(const HalStream::Record& record) {
  const std::vector<HalValue>& v = record.values;
  LatchedSample sample;
  sample.sequence = record.number;
  sample.axes = {v[0].f, v[1].f, v[2].f, v[3].f};
  sample.first_point = v[4].f;
  sample.program_line = v[5].s;
  sample.distance_mm = v[6].f;
  sample.snr = v[7].f;
  ProbeFlags flags = ProbeFlags::from_bits(static_cast<std::uint8_t>(v[8].u));
  if (!v[10].b && !flags.out_of_range) flags.missed = true;  // not valid for no reason of its own: no return
  sample.flags = flags.bits();
  sample.reading = v[9].u;
  sample.motion_enabled = v[11].b;
  return sample;
}

// sampler channel 1, to the virtual probe: x y z c, first point, line number, program line.
inline constexpr const char* kTriggerFields = "ffffffs";
inline constexpr int kTriggerChannel = 1;

// streamer channel 0, from the virtual probe: x y z c, first point, program line, distance, SNR, flags,
// reading, valid.
inline constexpr const char* kReadingFields = "fffffsffuub";
inline constexpr int kReadingChannel = 0;

}  // namespace trueblade
