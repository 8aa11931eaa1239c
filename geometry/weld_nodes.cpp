#include "geometry/weld_nodes.h"

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cmath>

namespace trueblade {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// Chained hash buckets of node numbers.
class Buckets {
 public:
  explicit Buckets(std::size_t nodes)
      : first_(std::bit_ceil(nodes + 1), kNone), next_(nodes, kNone), mask_(first_.size() - 1) {}

  void insert(std::uint64_t hash, std::uint32_t node) {
    next_[node] = first_[hash & mask_];
    first_[hash & mask_] = node;
  }
  template <class Visit>
  void for_each(std::uint64_t hash, const Visit& visit) const {
    for (std::uint32_t node = first_[hash & mask_]; node != kNone; node = next_[node]) visit(node);
  }

 private:
  std::vector<std::uint32_t> first_, next_;
  std::uint64_t mask_;
};

// Mixes three words into one (the finaliser of SplitMix64, applied after each).
std::uint64_t hash_of(const std::array<std::uint64_t, 3>& words) {
  std::uint64_t hash = 0;
  for (const std::uint64_t word : words) {
    hash = (hash ^ word) + 0x9e3779b97f4a7c15u;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
    hash ^= hash >> 31;
  }
  return hash;
}

std::vector<std::uint32_t> weld_equal(std::span<const Vec3> nodes) {
  std::vector<std::uint32_t> replacement(nodes.size());
  Buckets buckets(nodes.size());
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const Vec3 node = nodes[i].array() + 0.0;  // -0 becomes +0: equal numbers get equal bits
    const std::uint64_t hash =
        hash_of({std::bit_cast<std::uint64_t>(node.x()), std::bit_cast<std::uint64_t>(node.y()),
                 std::bit_cast<std::uint64_t>(node.z())});
    replacement[i] = i;
    buckets.for_each(hash, [&](std::uint32_t other) {
      if (nodes[other] == nodes[i]) replacement[i] = other;
    });
    if (replacement[i] == i) buckets.insert(hash, i);
  }
  return replacement;
}

}  // namespace

std::vector<std::uint32_t> weld_nodes(std::span<const Vec3> nodes_mm, double tolerance_mm) {
  std::vector<std::uint32_t> replacement = weld_equal(nodes_mm);
  if (tolerance_mm == 0.0 || nodes_mm.empty()) return replacement;

  Eigen::AlignedBox3d box;
  for (const Vec3& node : nodes_mm) box.extend(node);
  const double tolerance = std::max(tolerance_mm, box.sizes().maxCoeff() * 0x1p-44);
  if (tolerance == 0.0) return replacement;

  // Nodes that kept their place lie in a grid of cells four tolerances wide: a query touches 1.5^3 = 3.4
  // cells on average, and a cell holds at most about a hundred nodes, since they keep a tolerance's distance.
  const double cell = 4.0 * tolerance;
  const auto cell_of = [&](const Vec3& p) {
    const Vec3 scaled = ((p - box.min()) / cell).array().floor();
    return std::array<std::int64_t, 3>{static_cast<std::int64_t>(scaled.x()),
                                       static_cast<std::int64_t>(scaled.y()),
                                       static_cast<std::int64_t>(scaled.z())};
  };
  const auto hash_of_cell = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return hash_of(
        {static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(z)});
  };

  Buckets buckets(nodes_mm.size());
  for (std::uint32_t i = 0; i < nodes_mm.size(); ++i) {
    if (replacement[i] != i) {
      replacement[i] = replacement[replacement[i]];
      continue;
    }
    const Vec3& node = nodes_mm[i];
    const auto lowest = cell_of(node.array() - tolerance);
    const auto highest = cell_of(node.array() + tolerance);
    double nearest = tolerance;
    for (std::int64_t x = lowest[0]; x <= highest[0]; ++x)
      for (std::int64_t y = lowest[1]; y <= highest[1]; ++y)
        for (std::int64_t z = lowest[2]; z <= highest[2]; ++z)
          buckets.for_each(hash_of_cell(x, y, z), [&](std::uint32_t other) {
            const double distance = (nodes_mm[other] - node).norm();
            if (distance < nearest ||
                (distance == nearest && (replacement[i] == i || other < replacement[i]))) {
              nearest = distance;
              replacement[i] = other;
            }
          });
    if (replacement[i] != i) continue;
    const auto own = cell_of(node);
    buckets.insert(hash_of_cell(own[0], own[1], own[2]), i);
  }
  return replacement;
}

}  // namespace trueblade
