// The error sources of the virtual machine. Each is a Gaussian with a mean and a standard deviation and a
// scope that says how often it is drawn. Lengths in mm, angles in rad, times in s.
//
// Names follow ISO 230-1 and ISO 230-7, so that a calibration certificate can be typed in: E, the direction
// of the error (X Y Z: along; A B C: about X Y Z), the axis that moves. EYX is the straightness of x in the
// direction of y, ECX the yaw of x, C0Y the squareness of y to x, ECC the angular positioning of the rotary
// axis, XOC the place of the rotary axis along x. Which motion each one is, and in which frame it acts:
// true_geometry.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "geometry/random.h"

namespace trueblade {

enum class ErrorScope : std::uint8_t { setup, view, line, point };

struct GaussianError {
  double mean = 0.0;
  double sigma = 0.0;
  ErrorScope scope = ErrorScope::setup;
  // Which of many independent sequences of draws: variance-based indices draw one source anew and keep the
  // others as they were.
  std::uint32_t replicate = 0;
};

// The numbers key the random stream: append, never reorder.
enum class ErrorSource : std::uint8_t {
  // The part in its fixture and the fixture on the table: shift along and rotation about the fixture's axes.
  part_x,
  part_y,
  part_z,
  part_a,
  part_b,
  part_c,
  fixture_x,
  fixture_y,
  fixture_z,
  fixture_a,
  fixture_b,
  fixture_c,
  // The probe in its mount: shift along the probe's axes, tilt of the beam about its two normals.
  probe_x,
  probe_y,
  probe_z,
  beam_a,
  beam_b,
  // Linear axes: positioning and straightness, roll, pitch and yaw.
  exx,
  eyx,
  ezx,
  eax,
  ebx,
  ecx,
  exy,
  eyy,
  ezy,
  eay,
  eby,
  ecy,
  exz,
  eyz,
  ezz,
  eaz,
  ebz,
  ecz,
  // Squareness of y to x, of z to x, of z to y.
  c0y,
  b0z,
  a0z,
  // Rotary axis: radial, radial, axial, tilt, tilt, angular positioning; then place and direction of the
  // axis.
  exc,
  eyc,
  ezc,
  eac,
  ebc,
  ecc,
  xoc,
  yoc,
  aoc,
  boc,
  // Sensor distance (offset), time base (samples taken late, s), thermal drift of the probe (mm/s).
  sensor_distance,
  time_base,
  drift_x,
  drift_y,
  drift_z,
  count
};

inline constexpr std::size_t kErrorSourceCount = static_cast<std::size_t>(ErrorSource::count);

struct ErrorSourceInfo {
  std::string_view name;         // as in certificates and files: "EXX", "part_x"
  std::string_view unit;         // "mm", "rad", "s" or "mm/s"
  std::string_view description;  // in words
};
const ErrorSourceInfo& info(ErrorSource source);

class MachineErrors {
 public:
  GaussianError& operator[](ErrorSource source) { return sources_[static_cast<std::size_t>(source)]; }
  const GaussianError& operator[](ErrorSource source) const {
    return sources_[static_cast<std::size_t>(source)];
  }
  void validate() const;  // throws InputError naming the source: finite, sigma at least 0

 private:
  std::array<GaussianError, kErrorSourceCount> sources_;
};

// One draw of every source.
class ErrorValues {
 public:
  double& operator[](ErrorSource source) { return values_[static_cast<std::size_t>(source)]; }
  double operator[](ErrorSource source) const { return values_[static_cast<std::size_t>(source)]; }

 private:
  std::array<double, kErrorSourceCount> values_{};
};

// Draws the sources of one scope, number `index` of that scope (the third view, the 700th point), and leaves
// the others as they are. A pure function of (seed, trial, scope, index): no draw depends on an earlier one,
// nor on which other sources are in use.
void draw_errors(const MachineErrors& errors, ErrorScope scope, std::uint64_t seed, std::uint64_t trial,
                 std::uint64_t index, ErrorValues& values);

// The same for chosen sources of one scope, in ascending order, and `count` indices from `first` on, source
// by source: values[s * count + k] is sources[s] at index first + k. `stream` is error_stream(scope, seed,
// trial). Precondition: values.size() == sources.size() * count.
void draw_errors(const MachineErrors& errors, std::span<const ErrorSource> sources, const Rng& stream,
                 std::uint64_t first, std::size_t count, std::span<double> values);
Rng error_stream(ErrorScope scope, std::uint64_t seed, std::uint64_t trial);

// Where a replicate begins in its stream. Replicates are 2^48 draws apart: 4 * 10^12 points of 64 sources.
std::uint64_t replicate_start(std::uint32_t replicate);

}  // namespace trueblade
