#include "part/refine_facets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>

#include "geometry/parallel.h"

namespace trueblade {

namespace {

constexpr int kMostRounds = 6;  // an error falls to a quarter in each: 4^6 = 4096 times the tolerance
constexpr std::size_t kBlock = 1024;

struct Edge {
  std::array<std::uint32_t, 2> nodes;  // the lower number first
  std::uint32_t facet;
  std::uint8_t side;  // joins corner side and corner side + 1 of the facet
};

// An edge inside a surface, seen from its two facets.
struct InnerEdge {
  std::array<Edge, 2> seen_from;
};

struct NewNode {
  Vec3 point_mm;
  Vec2 parameters;
};

std::size_t next_corner(std::size_t k) {
  return (k + 1) % 3;
}

// Corner parameters of an edge in one facet, in the order of the edge's nodes.
std::array<Vec2, 2> parameters_along(const CadFacets& cad, const Edge& edge) {
  const auto& uv = cad.corner_parameters[edge.facet];
  const std::size_t a = edge.side, b = next_corner(a);
  if (cad.facets[edge.facet][a] == edge.nodes[0]) return {uv[a], uv[b]};
  return {uv[b], uv[a]};
}

// Edges of exactly two facets of one surface that agree about the parameters along it (on the seam of a
// closed surface they do not).
std::vector<InnerEdge> inner_edges(const CadFacets& cad) {
  std::vector<Edge> edges;
  edges.reserve(3 * cad.facets.size());
  for (std::uint32_t facet = 0; facet < cad.facets.size(); ++facet)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(cad.facets[facet][k], cad.facets[facet][next_corner(k)]);
      edges.push_back({{low, high}, facet, static_cast<std::uint8_t>(k)});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.nodes, a.facet, a.side) < std::tie(b.nodes, b.facet, b.side);
  });
  std::vector<InnerEdge> inner;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].nodes == edges[begin].nodes) ++end;
    if (end - begin != 2 || edges[begin].nodes[0] == edges[begin].nodes[1]) continue;
    const Edge &a = edges[begin], &b = edges[begin + 1];
    if (cad.surface_of_facet[a.facet] == cad.surface_of_facet[b.facet] &&
        parameters_along(cad, a) == parameters_along(cad, b))
      inner.push_back({{a, b}});
  }
  return inner;
}

// The foot of `point_mm` on the surface when it is farther away than the tolerance and lies where it is
// expected, not beyond a fold.
std::optional<NewNode> node_if_too_far(const CadFacets& cad, std::uint32_t surface, const Vec3& point_mm,
                                       const Vec2& parameters, double extent_in_parameters) {
  const auto foot = cad.exact->project(surface, point_mm, parameters);
  const bool as_expected =
      foot.converged && (foot.foot.parameters - parameters).norm() <= extent_in_parameters;
  if (!as_expected || foot.distance_mm <= cad.chord_tolerance_mm) return std::nullopt;
  return NewNode{foot.foot.point_mm, foot.foot.parameters};
}

std::optional<NewNode> node_in_the_middle(const CadFacets& cad, const InnerEdge& inner) {
  const Edge& edge = inner.seen_from[0];
  const auto uv = parameters_along(cad, edge);
  const Vec3 middle_mm = 0.5 * (cad.nodes_mm[edge.nodes[0]] + cad.nodes_mm[edge.nodes[1]]);
  return node_if_too_far(cad, cad.surface_of_facet[edge.facet], middle_mm, 0.5 * (uv[0] + uv[1]),
                         0.5 * (uv[1] - uv[0]).norm());
}

std::optional<NewNode> node_in_the_centre(const CadFacets& cad, std::uint32_t facet) {
  const auto& uv = cad.corner_parameters[facet];
  Vec3 centre_mm = Vec3::Zero();
  for (const std::uint32_t node : cad.facets[facet]) centre_mm += cad.nodes_mm[node] / 3.0;
  const Vec2 centre_uv = (uv[0] + uv[1] + uv[2]) / 3.0;
  const double extent =
      std::max({(uv[0] - centre_uv).norm(), (uv[1] - centre_uv).norm(), (uv[2] - centre_uv).norm()});
  return node_if_too_far(cad, cad.surface_of_facet[facet], centre_mm, centre_uv, extent);
}

// A corner of a facet to be: node and parameters.
struct Corner {
  std::uint32_t node;
  Vec2 parameters;
};

// One round: new nodes on too coarse edges, and in the centre of facets that are too coarse although their
// edges are not.
class Round {
 public:
  explicit Round(CadFacets& cad) : cad_(cad) {}

  // False when nothing had to be split.
  bool split() {
    on_edge_.assign(cad_.facets.size(), {});
    const std::size_t nodes_before = cad_.nodes_mm.size();
    split_edges();
    split_centres();
    if (cad_.nodes_mm.size() == nodes_before) return false;
    CadFacets old;
    std::swap(old.facets, cad_.facets);
    std::swap(old.surface_of_facet, cad_.surface_of_facet);
    std::swap(old.corner_parameters, cad_.corner_parameters);
    for (std::uint32_t facet = 0; facet < old.facets.size(); ++facet) emit_pieces(old, facet);
    return true;
  }

 private:
  CadFacets& cad_;
  std::vector<std::array<std::optional<Corner>, 3>> on_edge_;  // per facet and side
  std::vector<std::optional<Corner>> in_centre_;

  Corner add_node(const NewNode& node) {
    cad_.nodes_mm.push_back(node.point_mm);
    return {static_cast<std::uint32_t>(cad_.nodes_mm.size() - 1), node.parameters};
  }

  void split_edges() {
    const std::vector<InnerEdge> inner = inner_edges(cad_);
    std::vector<std::optional<NewNode>> middle(inner.size());
    parallel_for_blocks(inner.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) middle[i] = node_in_the_middle(cad_, inner[i]);
    });
    for (std::size_t i = 0; i < inner.size(); ++i) {
      if (!middle[i]) continue;
      const Corner corner = add_node(*middle[i]);
      for (const Edge& edge : inner[i].seen_from) on_edge_[edge.facet][edge.side] = corner;
    }
  }

  void split_centres() {
    std::vector<std::optional<NewNode>> centre(cad_.facets.size());
    parallel_for_blocks(centre.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t facet = begin; facet < end; ++facet) {
        const auto& sides = on_edge_[facet];
        if (!sides[0] && !sides[1] && !sides[2])
          centre[facet] = node_in_the_centre(cad_, static_cast<std::uint32_t>(facet));
      }
    });
    in_centre_.assign(centre.size(), std::nullopt);
    for (std::size_t facet = 0; facet < centre.size(); ++facet)
      if (centre[facet]) in_centre_[facet] = add_node(*centre[facet]);
  }

  void emit(std::uint32_t surface, const Corner& a, const Corner& b, const Corner& c) {
    cad_.facets.push_back({a.node, b.node, c.node});
    cad_.surface_of_facet.push_back(surface);
    cad_.corner_parameters.push_back({a.parameters, b.parameters, c.parameters});
  }

  void emit_pieces(const CadFacets& old, std::uint32_t facet) {
    const std::uint32_t surface = old.surface_of_facet[facet];
    std::array<Corner, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = {old.facets[facet][k], old.corner_parameters[facet][k]};
    const auto& middle = on_edge_[facet];
    if (const auto& centre = in_centre_[facet]) {
      for (std::size_t k = 0; k < 3; ++k) emit(surface, corner[k], corner[next_corner(k)], *centre);
      return;
    }
    if (middle[0] && middle[1] && middle[2]) {
      for (std::size_t k = 0; k < 3; ++k) emit(surface, corner[k], *middle[k], *middle[(k + 2) % 3]);
      emit(surface, *middle[0], *middle[1], *middle[2]);
      return;
    }
    // One or two sides: cut off the corner behind each split side in turn.
    std::size_t k = 0;
    while (k < 3 && !(middle[k] && !middle[(k + 2) % 3])) ++k;
    if (k == 3) {
      emit(surface, corner[0], corner[1], corner[2]);
      return;
    }
    const std::size_t next = next_corner(k), last = next_corner(next);
    emit(surface, *middle[k], corner[last], corner[k]);
    if (middle[next]) {
      emit(surface, *middle[k], corner[next], *middle[next]);
      emit(surface, *middle[k], *middle[next], corner[last]);
    } else {
      emit(surface, *middle[k], corner[next], corner[last]);
    }
  }
};

}  // namespace

void refine_facets(CadFacets& cad) {
  for (int round = 0; round < kMostRounds; ++round)
    if (!Round(cad).split()) return;
}

}  // namespace trueblade
