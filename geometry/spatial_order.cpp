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

// Position of a cell along the curve: Skilling's transform, then the axes' bits interleaved.
std::uint32_t hilbert_key(std::array<std::uint32_t, 3> cell) {
  for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (std::uint32_t& axis : cell) {
      // Bit set: invert the first axis below it; clear: exchange both there.
      const std::uint32_t set = axis & bit ? below : 0;
      const std::uint32_t exchanged = (cell[0] ^ axis) & below & ~set;
      cell[0] ^= set | exchanged;
      axis ^= exchanged;
    }
  }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t gray = 0;
  for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1)
    if (cell[2] & bit) gray ^= bit - 1;
  std::uint32_t key = 0;
  for (int bit = kBits - 1; bit >= 0; --bit)
    for (const std::uint32_t axis : cell) key = key << 1 | ((axis ^ gray) >> bit & 1U);
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
    for (std::size_t i = begin; i < end; ++i) {
      std::array<std::uint32_t, 3> cell{};
      if (points_mm[i].allFinite())
        for (int axis = 0; axis < 3; ++axis)
          cell[axis] = static_cast<std::uint32_t>((0.5 * points_mm[i][axis] - 0.5 * lower[axis]) * 2.0 *
                                                  cells_per_half);
      keyed[i] = {hilbert_key(cell), static_cast<std::uint32_t>(i)};
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
