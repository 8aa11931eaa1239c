// Keyed random numbers: a pure function of (seed, trial, stream, index), so that no result depends on
// threads, ranks or order, and any trial reruns alone and identically. The generator is Philox4x64-10 (Salmon
// et al. 2011, Random123).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "geometry/vector.h"

namespace trueblade {

class Rng {
 public:
  // A stream starts at index 0. Streams with different keys are independent.
  Rng(std::uint64_t seed, std::uint64_t trial, std::uint64_t stream)
      : seed_(seed), trial_(trial), stream_(stream) {}

  // A stream named by text, for error sources and the like (the name is hashed with FNV-1a).
  Rng(std::uint64_t seed, std::uint64_t trial, std::string_view stream_name);

  // The same key from the position `index`: draws number index, index+1, ... Costs nothing.
  Rng at(std::uint64_t index) const;

  std::uint64_t bits();  // 64 uniform bits
  double uniform();      // in the open interval (0, 1): an odd multiple of 2^-53
  double normal();       // standard normal, by the inverse distribution function: one uniform, one deviate
  Vec3 normal_vector();  // three independent standard normals

  // The uniforms of blocks `first`, first + stride, ..., wherever the stream stands: what many draws are
  // cheapest in. Block b holds the draws number 4 b to 4 b + 3. uniforms[word * count + k] is draw `word` of
  // the k-th block. Precondition: uniforms.size() == 4 * count.
  void uniforms_of_blocks(std::uint64_t first, std::uint64_t stride, std::size_t count,
                          std::span<double> uniforms) const;

 private:
  // Philox key (seed, trial), counter (index / 4, stream, 0, 0); the draw is word index % 4 of its block.
  std::uint64_t seed_, trial_, stream_, index_ = 0;
  std::array<std::uint64_t, 4> block_{};
  bool block_drawn_ = false;  // block_ holds the words of block index_ / 4, unless index_ % 4 is 0
};

// Inverse of the standard normal distribution function, relative error below 1e-15 (Wichura 1988, algorithm
// AS 241, PPND16). Ours because std::normal_distribution differs between standard libraries. Precondition: 0
// < p < 1.
double inverse_normal(double p);

// Every number of `p` replaced by its inverse_normal, bit for bit, on any instruction set; a few times as
// fast.
void inverse_normal(std::span<double> p);

}  // namespace trueblade
