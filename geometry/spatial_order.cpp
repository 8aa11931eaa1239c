#include "geometry/spatial_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr int kBits = 10;             // per axis
constexpr std::size_t kBlock = 8192;  // points of one task

struct Keyed {
  std::uint32_t key, point;
};

// Several cells beside one another, so that the compiler makes vectors of them.
constexpr std::size_t kLanes = 16;
using Lanes = std::array<std::uint32_t, kLanes>;

// The lower ten bits of x, each two places apart from the next.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000FFU;
  x = (x | x << 8) & 0x0300F00FU;
  x = (x | x << 4) & 0x030C30C3U;
  return (x | x << 2) & 0x09249249U;
}

// Positions of cells along the curve: Skilling's transform, then the axes' bits interleaved.
Lanes hilbert_keys(Lanes x, Lanes y, Lanes z) {
  // Where an axis has the bit set, the first axis is inverted below it; else the two are exchanged there.
  const auto turn = [](std::uint32_t& first, std::uint32_t& axis, std::uint32_t bit) {
    const std::uint32_t below = bit - 1, set = axis & bit ? below : 0;
    const std::uint32_t exchanged = (first ^ axis) & (below ^ set);
    first ^= set | exchanged;
    axis ^= exchanged;
  };
  Lanes gray{}, key;
  for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1)
    for (std::size_t k = 0; k < kLanes; ++k) {
      x[k] ^= x[k] & bit ? bit - 1 : 0;
      turn(x[k], y[k], bit);
      turn(x[k], z[k], bit);
    }
  for (std::size_t k = 0; k < kLanes; ++k) {
    y[k] ^= x[k];
    z[k] ^= y[k];
  }
  for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1)
    for (std::size_t k = 0; k < kLanes; ++k) gray[k] ^= z[k] & bit ? bit - 1 : 0;
  for (std::size_t k = 0; k < kLanes; ++k)
    key[k] = spread(x[k] ^ gray[k]) << 2 | spread(y[k] ^ gray[k]) << 1 | spread(z[k] ^ gray[k]);
  return key;
}

// One pass of a radix sort by the ten bits from `shift` on; keeps the order of equal ones.
void sort_by_digit(const std::vector<Keyed>& from, std::vector<Keyed>& to, int shift) {
  constexpr std::uint32_t kDigits = 1U << kBits;
  std::array<std::uint32_t, kDigits> place{};
  for (const Keyed& keyed : from) ++place[keyed.key >> shift & (kDigits - 1)];
  std::uint32_t next = 0;
  for (std::uint32_t& digit : place) next += std::exchange(digit, next);
  for (const Keyed& keyed : from) to[place[keyed.key >> shift & (kDigits - 1)]++] = keyed;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points_mm) {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (const Vec3& point : points_mm) {
    if (!point.allFinite()) continue;
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  // Cubic cells. Half the range first, because the range itself may overflow.
  const double half_size = (0.5 * upper - 0.5 * lower).maxCoeff();
  const double cells_per_half = half_size > 0.0 ? 0.5 * ((1 << kBits) - 1) / half_size : 0.0;

  std::vector<Keyed> keyed(points_mm.size()), sorted(points_mm.size());
  parallel_for_blocks(points_mm.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t first = begin; first < end; first += kLanes) {
      const std::size_t count = std::min(kLanes, end - first);
      std::array<Lanes, 3> cell{};
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3& point = points_mm[first + k];
        if (!point.allFinite()) continue;
        for (int axis = 0; axis < 3; ++axis)
          cell[axis][k] =
              static_cast<std::uint32_t>((0.5 * point[axis] - 0.5 * lower[axis]) * 2.0 * cells_per_half);
      }
      const Lanes key = hilbert_keys(cell[0], cell[1], cell[2]);
      for (std::size_t k = 0; k < count; ++k)
        keyed[first + k] = {key[k], static_cast<std::uint32_t>(first + k)};
    }
  });
  for (int shift = 0; shift < 3 * kBits; shift += kBits) {
    sort_by_digit(keyed, sorted, shift);
    keyed.swap(sorted);
  }
  std::vector<std::uint32_t> order(points_mm.size());
  std::transform(keyed.begin(), keyed.end(), order.begin(), [](const Keyed& k) { return k.point; });
  return order;
}

}  // namespace trueblade
