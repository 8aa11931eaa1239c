#include "sim/deform_model.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr std::size_t kMostFacets = 20'000'000;  // 3 GB with the ray caster's tree

struct RefinedFacets {
  std::vector<Vec3> nodes_mm;
  std::vector<std::array<std::uint32_t, 3>> facets;
  std::vector<std::uint32_t> nominal_facet;
};

// The middles of the edges that are too long, by their two node numbers.
class EdgeMiddles {
 public:
  EdgeMiddles(RefinedFacets& refined, const DisplacementField& field) : refined_(refined), field_(field) {}

  // The node in the middle of the edge, made when first asked for; nothing when the edge is short enough.
  std::optional<std::uint32_t> middle(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
    if (const auto known = middles_.find(key); known != middles_.end()) return known->second;
    const Vec3 middle = 0.5 * (refined_.nodes_mm[a] + refined_.nodes_mm[b]);
    const double length_mm = (refined_.nodes_mm[a] - refined_.nodes_mm[b]).norm();
    std::optional<std::uint32_t> node;
    if (length_mm > field_.edge_length_limit_mm(middle)) {
      node = static_cast<std::uint32_t>(refined_.nodes_mm.size());
      refined_.nodes_mm.push_back(middle);
    }
    middles_.emplace(key, node);
    return node;
  }

 private:
  RefinedFacets& refined_;
  const DisplacementField& field_;
  std::unordered_map<std::uint64_t, std::optional<std::uint32_t>> middles_;
};

// One round: every facet is cut at the middles of its long edges, into two, three or four. Returns whether
// any was.
bool halve_long_edges(RefinedFacets& refined, const DisplacementField& field) {
  EdgeMiddles edges(refined, field);
  std::vector<std::array<std::uint32_t, 3>> facets;
  std::vector<std::uint32_t> nominal_facet;
  facets.reserve(refined.facets.size());
  nominal_facet.reserve(refined.facets.size());
  for (std::size_t f = 0; f < refined.facets.size(); ++f) {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      facets.push_back({a, b, c});
      nominal_facet.push_back(refined.nominal_facet[f]);
    };
    // Turned so that the cut edges come first: (none), ab, ab and bc, or all.
    std::array<std::uint32_t, 3> n = refined.facets[f];
    std::array<std::optional<std::uint32_t>, 3> m{edges.middle(n[0], n[1]), edges.middle(n[1], n[2]),
                                                  edges.middle(n[2], n[0])};
    const int cuts = (m[0] ? 1 : 0) + (m[1] ? 1 : 0) + (m[2] ? 1 : 0);
    while ((cuts == 1 && !m[0]) || (cuts == 2 && m[2])) {
      std::rotate(n.begin(), n.begin() + 1, n.end());
      std::rotate(m.begin(), m.begin() + 1, m.end());
    }
    const auto [a, b, c] = n;
    if (cuts == 0) {
      add(a, b, c);
    } else if (cuts == 1) {
      add(a, *m[0], c);
      add(*m[0], b, c);
    } else if (cuts == 2) {
      add(*m[0], b, *m[1]);
      // The quadrangle a, m0, m1, c is cut along its shorter diagonal.
      const auto length = [&](std::uint32_t p, std::uint32_t q) {
        return (refined.nodes_mm[p] - refined.nodes_mm[q]).squaredNorm();
      };
      if (length(a, *m[1]) <= length(*m[0], c)) {
        add(a, *m[0], *m[1]);
        add(a, *m[1], c);
      } else {
        add(a, *m[0], c);
        add(*m[0], *m[1], c);
      }
    } else {
      add(a, *m[0], *m[2]);
      add(*m[0], b, *m[1]);
      add(*m[1], c, *m[2]);
      add(*m[0], *m[1], *m[2]);
    }
    if (facets.size() > kMostFacets)
      throw InputError(
          fmt::format("form errors: their details need more than {} facets on this part; make the "
                      "smallest radius, blend or correlation length larger",
                      kMostFacets));
  }
  const bool changed = facets.size() > refined.facets.size();
  refined.facets = std::move(facets);
  refined.nominal_facet = std::move(nominal_facet);
  return changed;
}

std::vector<Vec3> node_normals(const RefinedFacets& refined) {
  std::vector<Vec3> normals(refined.nodes_mm.size(), Vec3::Zero());
  for (const auto& n : refined.facets) {
    const std::array<Vec3, 3> p{refined.nodes_mm[n[0]], refined.nodes_mm[n[1]], refined.nodes_mm[n[2]]};
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 to_next = (p[(k + 1) % 3] - p[k]).normalized();
      const Vec3 to_previous = (p[(k + 2) % 3] - p[k]).normalized();
      normals[n[k]] += std::acos(std::clamp(to_next.dot(to_previous), -1.0, 1.0)) * normal;
    }
  }
  for (Vec3& normal : normals) normal.stableNormalize();
  return normals;
}

}  // namespace

DeformedModel deform_model(const FacetModel& nominal, const DisplacementField& field) {
  RefinedFacets refined;
  for (std::uint32_t node = 0; node < nominal.node_count(); ++node)
    refined.nodes_mm.push_back(nominal.node_mm(node));
  for (std::uint32_t facet = 0; facet < nominal.facet_count(); ++facet) {
    // Nodes that were doubled at non-manifold edges become one again, so that both facets see one middle.
    std::array<std::uint32_t, 3> nodes = nominal.facet_nodes(facet);
    for (std::uint32_t& node : nodes) node = nominal.welded_node(node);
    refined.facets.push_back(nodes);
    refined.nominal_facet.push_back(facet);
  }
  while (halve_long_edges(refined, field)) {
  }

  const std::vector<Vec3> normals = node_normals(refined);
  FacetSoup soup;
  soup.nodes_mm.resize(refined.nodes_mm.size());
  parallel_for_blocks(soup.nodes_mm.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node)
      soup.nodes_mm[node] =
          refined.nodes_mm[node] + field.displacement_mm(refined.nodes_mm[node], normals[node]);
  });
  const bool displaced = soup.nodes_mm != refined.nodes_mm;
  soup.facets = std::move(refined.facets);
  soup.surface_of_facet.reserve(soup.facets.size());
  for (const std::uint32_t facet : refined.nominal_facet)
    soup.surface_of_facet.push_back(nominal.surface_of(facet));

  FacetModelBuild build = build_facet_model(soup, 0.0);
  DeformedModel deformed;
  deformed.displaced = displaced;
  deformed.model = std::move(build.model);
  deformed.nominal_facet.reserve(build.soup_facet.size());
  for (const std::uint32_t facet : build.soup_facet)
    deformed.nominal_facet.push_back(refined.nominal_facet[facet]);
  return deformed;
}

}  // namespace trueblade
