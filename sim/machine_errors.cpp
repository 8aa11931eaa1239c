#include "sim/machine_errors.h"

#include <fmt/core.h>

#include <cmath>

#include "geometry/error.h"
#include "geometry/random.h"

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

std::string_view stream_of(ErrorScope scope) {
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
static_assert(kErrorSourceCount <= kPlacesPerIndex);

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

void draw_errors(const MachineErrors& errors, ErrorScope scope, std::uint64_t seed, std::uint64_t trial,
                 std::uint64_t index, ErrorValues& values) {
  const Rng stream(seed, trial, stream_of(scope));
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    const GaussianError& error = errors[source];
    if (error.scope != scope) continue;
    values[source] = error.mean;
    if (error.sigma > 0.0) values[source] += error.sigma * stream.at(index * kPlacesPerIndex + s).normal();
  }
}

}  // namespace trueblade
