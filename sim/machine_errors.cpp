#include "sim/machine_errors.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/error.h"

namespace trueblade {
namespace {

constexpr std::array<ErrorSourceInfo, kErrorSourceCount> kInfo{{
    {"part_x", "mm", "part in fixture, shift along x of the fixture"},
    {"part_y", "mm", "part in fixture, shift along y"},
    {"part_z", "mm", "part in fixture, shift along z"},
    {"part_a", "rad", "part in fixture, rotation about x"},
    {"part_b", "rad", "part in fixture, rotation about y"},
    {"part_c", "rad", "part in fixture, rotation about z"},
    {"fixture_x", "mm", "fixture on table, shift along x of the fixture"},
    {"fixture_y", "mm", "fixture on table, shift along y"},
    {"fixture_z", "mm", "fixture on table, shift along z"},
    {"fixture_a", "rad", "fixture on table, rotation about x"},
    {"fixture_b", "rad", "fixture on table, rotation about y"},
    {"fixture_c", "rad", "fixture on table, rotation about z"},
    {"probe_x", "mm", "probe in its mount, shift along x of the probe"},
    {"probe_y", "mm", "probe in its mount, shift along y"},
    {"probe_z", "mm", "probe in its mount, shift along z"},
    {"beam_a", "rad", "beam direction, tilt about its first normal"},
    {"beam_b", "rad", "beam direction, tilt about its second normal"},
    {"EXX", "mm", "positioning of x"},
    {"EYX", "mm", "straightness of x in y"},
    {"EZX", "mm", "straightness of x in z"},
    {"EAX", "rad", "roll of x"},
    {"EBX", "rad", "pitch of x"},
    {"ECX", "rad", "yaw of x"},
    {"EXY", "mm", "straightness of y in x"},
    {"EYY", "mm", "positioning of y"},
    {"EZY", "mm", "straightness of y in z"},
    {"EAY", "rad", "pitch of y"},
    {"EBY", "rad", "roll of y"},
    {"ECY", "rad", "yaw of y"},
    {"EXZ", "mm", "straightness of z in x"},
    {"EYZ", "mm", "straightness of z in y"},
    {"EZZ", "mm", "positioning of z"},
    {"EAZ", "rad", "pitch of z"},
    {"EBZ", "rad", "yaw of z"},
    {"ECZ", "rad", "roll of z"},
    {"C0Y", "rad", "squareness of y to x"},
    {"B0Z", "rad", "squareness of z to x"},
    {"A0Z", "rad", "squareness of z to y"},
    {"EXC", "mm", "rotary axis, radial error motion along x"},
    {"EYC", "mm", "rotary axis, radial error motion along y"},
    {"EZC", "mm", "rotary axis, axial error motion"},
    {"EAC", "rad", "rotary axis, tilt error motion about x"},
    {"EBC", "rad", "rotary axis, tilt error motion about y"},
    {"ECC", "rad", "rotary axis, angular positioning"},
    {"XOC", "mm", "place of the rotary axis along x"},
    {"YOC", "mm", "place of the rotary axis along y"},
    {"AOC", "rad", "direction of the rotary axis, about x"},
    {"BOC", "rad", "direction of the rotary axis, about y"},
    {"sensor_distance", "mm", "offset of the sensor's distance"},
    {"time_base", "s", "distance taken later than the axis positions"},
    {"drift_x", "mm/s", "thermal drift of the probe along x of the stage"},
    {"drift_y", "mm/s", "thermal drift of the probe along y"},
    {"drift_z", "mm/s", "thermal drift of the probe along z"},
}};

std::string_view stream_name(ErrorScope scope) {
  switch (scope) {
    case ErrorScope::setup:
      return "errors per set-up";
    case ErrorScope::view:
      return "errors per view";
    case ErrorScope::line:
      return "errors per line";
    case ErrorScope::point:
      return "errors per point";
  }
  return {};
}

// Draws per index in a scope's stream, one place per source and some for sources to come.
constexpr std::uint64_t kPlacesPerIndex = 64;
static_assert(kErrorSourceCount <= kPlacesPerIndex && kPlacesPerIndex % 4 == 0);

}  // namespace

const ErrorSourceInfo& info(ErrorSource source) {
  return kInfo[static_cast<std::size_t>(source)];
}

void MachineErrors::validate() const {
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    if (!std::isfinite(sources_[s].mean))
      throw InputError(
          fmt::format("error source {}: mean is {}, must be finite", kInfo[s].name, sources_[s].mean));
    if (!(sources_[s].sigma >= 0.0 && std::isfinite(sources_[s].sigma)))
      throw InputError(
          fmt::format("error source {}: sigma is {}, must be at least 0", kInfo[s].name, sources_[s].sigma));
  }
}

Rng error_stream(ErrorScope scope, std::uint64_t seed, std::uint64_t trial) {
  return Rng(seed, trial, stream_name(scope));
}

std::uint64_t replicate_start(std::uint32_t replicate) {
  return std::uint64_t{replicate} << 48;
}

void draw_errors(const MachineErrors& errors, std::span<const ErrorSource> sources, const Rng& stream,
                 std::uint64_t first, std::size_t count, std::span<double> values) {
  // The draw of a source lies at `place` of its index's stretch, a multiple of four draws long: sources of
  // one block of four take their uniforms from one block.
  const auto place = [&](std::size_t s) {
    return replicate_start(errors[sources[s]].replicate) + static_cast<std::uint64_t>(sources[s]);
  };
  // Indices whose uniforms are drawn together: a block's stay in the nearest cache.
  constexpr std::size_t kTogether = 64;
  std::array<double, 4 * kTogether> uniforms;
  for (std::size_t begin = 0, end = 0; begin < sources.size(); begin = end) {
    bool drawn = false;
    for (end = begin; end < sources.size() && place(end) / 4 == place(begin) / 4; ++end)
      drawn = drawn || errors[sources[end]].sigma != 0.0;
    // Without a draw the deviate of the middle, 0, does.
    if (!drawn) std::fill_n(values.data() + begin * count, (end - begin) * count, 0.5);
    for (std::size_t k = 0; k < count && drawn; k += kTogether) {
      const std::size_t together = std::min(kTogether, count - k);
      stream.uniforms_of_blocks(place(begin) / 4 + (first + k) * (kPlacesPerIndex / 4), kPlacesPerIndex / 4,
                                together, std::span(uniforms).first(4 * together));
      for (std::size_t s = begin; s < end; ++s)
        std::copy_n(uniforms.data() + place(s) % 4 * together, together, values.data() + s * count + k);
    }
  }
  inverse_normal(values);
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const GaussianError& error = errors[sources[s]];
    for (double& value : values.subspan(s * count, count)) value = error.mean + error.sigma * value;
  }
}

void draw_errors(const MachineErrors& errors, ErrorScope scope, std::uint64_t seed, std::uint64_t trial,
                 std::uint64_t index, ErrorValues& values) {
  std::vector<ErrorSource> sources;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s)
    if (errors[static_cast<ErrorSource>(s)].scope == scope) sources.push_back(static_cast<ErrorSource>(s));
  std::vector<double> drawn(sources.size());
  draw_errors(errors, sources, error_stream(scope, seed, trial), index, 1, drawn);
  for (std::size_t s = 0; s < sources.size(); ++s) values[sources[s]] = drawn[s];
}

}  // namespace trueblade
