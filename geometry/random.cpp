#include "geometry/random.h"

#include <Random123/philox.h>

#include "geometry/fnv1a.h"

namespace trueblade {
namespace {

inline std::array<std::uint64_t, 4> philox_block(std::uint64_t seed, std::uint64_t trial,
                                                 std::uint64_t stream, std::uint64_t block) {
  const r123::Philox4x64 philox;
  const auto words = philox({{block, stream, 0, 0}}, {{seed, trial}});
  return {words[0], words[1], words[2], words[3]};
}

// The middle of one of 2^52 equal cells: exact in double, and never 0 or 1.
double uniform_of(std::uint64_t bits) {
  return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

}  // namespace

Rng::Rng(std::uint64_t seed, std::uint64_t trial, std::string_view stream_name)
    : Rng(seed, trial, fnv1a(stream_name)) {}

Rng Rng::at(std::uint64_t index) const {
  Rng moved(seed_, trial_, stream_);
  moved.index_ = index;
  return moved;
}

std::uint64_t Rng::bits() {
  const std::uint64_t word = index_ % 4;
  if (word == 0 || !block_drawn_) {
    block_ = philox_block(seed_, trial_, stream_, index_ / 4);
    block_drawn_ = true;
  }
  ++index_;
  return block_[word];
}

double Rng::uniform() {
  return uniform_of(bits());
}

void Rng::uniforms_of_blocks(std::uint64_t first, std::uint64_t stride, std::size_t count,
                             std::span<double> uniforms) const {
  for (std::size_t k = 0; k < count; ++k) {
    const auto words = philox_block(seed_, trial_, stream_, first + k * stride);
    for (std::size_t word = 0; word < 4; ++word) uniforms[word * count + k] = uniform_of(words[word]);
  }
}

double Rng::normal() {
  return inverse_normal(uniform());
}

Vec3 Rng::normal_vector() {
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

}  // namespace trueblade
