#include "geometry/facet_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "geometry/error.h"
#include "geometry/facet_edges.h"
#include "geometry/triangle.h"
#include "geometry/union_find.h"
#include "geometry/weld_nodes.h"

namespace trueblade {
namespace {

using Nodes = std::array<std::uint32_t, 3>;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// No part is larger than 1000 km; beyond that, areas and volumes would soon leave the range of float and
// double.
constexpr double kLargestCoordinateMm = 1e9;

// OpenMesh numbers half-edges by int; a facet brings at most three edges, six half-edges.
constexpr std::size_t kMostFacets = std::numeric_limits<int>::max() / 6;

void validate(const FacetSoup& soup, double weld_tolerance_mm) {
  if (!(weld_tolerance_mm >= 0.0) || !std::isfinite(weld_tolerance_mm))
    throw InputError("weld tolerance is " + std::to_string(weld_tolerance_mm) +
                     " mm, must be finite and not negative");
  if (soup.facets.empty()) throw InputError("no facets");
  if (soup.facets.size() > kMostFacets)
    throw InputError(std::to_string(soup.facets.size()) + " facets, must be at most " +
                     std::to_string(kMostFacets));
  if (!soup.surface_of_facet.empty() && soup.surface_of_facet.size() != soup.facets.size())
    throw InputError(std::to_string(soup.surface_of_facet.size()) + " surface numbers for " +
                     std::to_string(soup.facets.size()) + " facets, must be one for each or none");
  for (std::size_t i = 0; i < soup.nodes_mm.size(); ++i) {
    const Vec3& node = soup.nodes_mm[i];
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(node[axis]) <= kLargestCoordinateMm))
        throw InputError("node " + std::to_string(i) + " (counted from 0): coordinate is " +
                         std::to_string(node[axis]) + " mm, must be finite and within 1e9 mm");
  }
  for (std::size_t i = 0; i < soup.facets.size(); ++i)
    for (const std::uint32_t node : soup.facets[i])
      if (node >= soup.nodes_mm.size())
        throw InputError("facet " + std::to_string(i) + " (counted from 0): node number is " +
                         std::to_string(node) + ", must be below the " +
                         std::to_string(soup.nodes_mm.size()) + " nodes");
}

// True when the three nodes lie on a line to the rounding of their coordinates: the height over the longest
// edge is at most four ulps of the largest coordinate.
bool has_no_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double largest_coordinate =
      std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
  const double longest_edge = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return triangle_area_vector(a, b, c).norm() <= 4.0 * 0x1p-52 * largest_coordinate * longest_edge;
}

// The facets that stay: their nodes after welding (numbers of the soup) and their numbers in the soup.
struct KeptFacets {
  std::vector<Nodes> nodes;
  std::vector<std::uint32_t> soup_facet;
};

KeptFacets drop_degenerate(const FacetSoup& soup, const std::vector<std::uint32_t>& replacement,
                           FacetModelReport& report) {
  KeptFacets kept;
  kept.nodes.reserve(soup.facets.size());
  kept.soup_facet.reserve(soup.facets.size());
  for (std::uint32_t facet = 0; facet < soup.facets.size(); ++facet) {
    const auto& [i, j, k] = soup.facets[facet];
    const Nodes nodes{replacement[i], replacement[j], replacement[k]};
    if (nodes[0] == nodes[1] || nodes[1] == nodes[2] || nodes[2] == nodes[0] ||
        has_no_area(soup.nodes_mm[nodes[0]], soup.nodes_mm[nodes[1]], soup.nodes_mm[nodes[2]])) {
      ++report.degenerate_removed;
      continue;
    }
    kept.nodes.push_back(nodes);
    kept.soup_facet.push_back(facet);
  }
  return kept;
}

KeptFacets drop_duplicates(const KeptFacets& facets, FacetModelReport& report) {
  struct Key {
    Nodes nodes;
    std::uint32_t facet;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(facets.nodes.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    keys[i] = {facets.nodes[i], i};
    std::sort(keys[i].nodes.begin(), keys[i].nodes.end());
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> duplicate(keys.size(), false);
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (keys[i].nodes == keys[i - 1].nodes) duplicate[keys[i].facet] = true;

  KeptFacets kept;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (duplicate[i]) {
      ++report.duplicate_removed;
      continue;
    }
    kept.nodes.push_back(facets.nodes[i]);
    kept.soup_facet.push_back(facets.soup_facet[i]);
  }
  return kept;
}

// Renumbers the nodes in use from 0, in the soup's order; returns the soup's number of each.
std::vector<std::uint32_t> renumber_nodes(std::vector<Nodes>& facets, std::size_t soup_nodes) {
  std::vector<std::uint32_t> number(soup_nodes, kNone);
  for (const Nodes& nodes : facets)
    for (const std::uint32_t node : nodes) number[node] = 0;
  std::vector<std::uint32_t> soup_node;
  for (std::uint32_t node = 0; node < soup_nodes; ++node) {
    if (number[node] == kNone) continue;
    number[node] = static_cast<std::uint32_t>(soup_node.size());
    soup_node.push_back(node);
  }
  for (Nodes& nodes : facets)
    for (std::uint32_t& node : nodes) node = number[node];
  return soup_node;
}

// Two facets that run along their edge in opposite directions, and no third: the edge of an oriented
// manifold.
bool is_manifold(std::span<const EdgeUse> uses) {
  return uses.size() == 2 && uses[0].forward != uses[1].forward;
}

// A corner is 3 * facet + k; corner_at(use) is where the edge starts in its facet, corner_after(use) where it
// ends.
std::uint32_t corner_at(const EdgeUse& use) {
  return 3 * use.facet + use.edge;
}
std::uint32_t corner_after(const EdgeUse& use) {
  return 3 * use.facet + (use.edge + 1) % 3;
}

// Corners that are joined around their node through manifold edges form a fan, and every fan becomes one node
// of the mesh. A fan is a path or a cycle of facets, so that each of its edges has at most two facets and
// these run in opposite directions: what results is always an oriented manifold.
struct Fans {
  std::vector<Nodes> facets;               // with the fans' numbers
  std::vector<std::uint32_t> welded_node;  // of each fan
};

Fans split_into_fans(const std::vector<Nodes>& facets, std::size_t node_count, const FacetEdges& edges) {
  UnionFind corners(3 * facets.size());
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    const auto uses = edges.uses(edge);
    if (!is_manifold(uses)) continue;
    corners.unite(corner_at(uses[0]), corner_after(uses[1]));
    corners.unite(corner_after(uses[0]), corner_at(uses[1]));
  }

  Fans fans{std::vector<Nodes>(facets.size()), std::vector<std::uint32_t>(node_count)};
  for (std::uint32_t node = 0; node < node_count; ++node) fans.welded_node[node] = node;
  std::vector<bool> node_taken(node_count, false);
  std::vector<std::uint32_t> fan_of_root(3 * facets.size(), kNone);
  for (std::uint32_t corner = 0; corner < 3 * facets.size(); ++corner) {
    std::uint32_t& fan = fan_of_root[corners.root(corner)];
    if (fan == kNone) {
      const std::uint32_t node = facets[corner / 3][corner % 3];
      fan = node_taken[node] ? static_cast<std::uint32_t>(fans.welded_node.size()) : node;
      if (node_taken[node]) fans.welded_node.push_back(node);
      node_taken[node] = true;
    }
    fans.facets[corner / 3][corner % 3] = fan;
  }
  return fans;
}

// Number of closed loops of boundary edges. At a node a loop goes on within the fan of its facet; where the
// fan ends at an edge that is no boundary (three facets, or disagreeing ones), it goes on with the node's
// only other loose end.
std::size_t count_holes(const Fans& fans, const FacetEdges& edges) {
  struct LooseEnd {
    std::uint32_t welded_node, fan, boundary_edge;
  };
  std::vector<LooseEnd> ends;
  std::uint32_t boundary_edges = 0;
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    if (edges.uses(edge).size() != 1) continue;
    const EdgeUse use = edges.uses(edge)[0];
    for (const std::uint32_t corner : {corner_at(use), corner_after(use)}) {
      const std::uint32_t fan = fans.facets[corner / 3][corner % 3];
      ends.push_back({fans.welded_node[fan], fan, boundary_edges});
    }
    ++boundary_edges;
  }
  std::sort(ends.begin(), ends.end(), [](const LooseEnd& a, const LooseEnd& b) {
    return std::tie(a.welded_node, a.fan, a.boundary_edge) < std::tie(b.welded_node, b.fan, b.boundary_edge);
  });

  UnionFind loops(boundary_edges);
  std::vector<bool> open(boundary_edges, false);
  std::vector<std::uint32_t> unpaired;
  for (std::size_t i = 0; i < ends.size();) {
    const bool paired = i + 1 < ends.size() && ends[i + 1].fan == ends[i].fan;
    if (paired)
      loops.unite(ends[i].boundary_edge, ends[i + 1].boundary_edge);
    else
      unpaired.push_back(ends[i].boundary_edge);
    const std::uint32_t node = ends[i].welded_node;
    i += paired ? 2 : 1;
    if (i < ends.size() && ends[i].welded_node == node) continue;
    if (unpaired.size() == 2)
      loops.unite(unpaired[0], unpaired[1]);
    else
      for (const std::uint32_t edge : unpaired) open[edge] = true;
    unpaired.clear();
  }
  std::vector<bool> root_open(boundary_edges, false);
  for (std::uint32_t edge = 0; edge < boundary_edges; ++edge)
    if (open[edge]) root_open[loops.root(edge)] = true;
  std::size_t holes = 0;
  for (std::uint32_t edge = 0; edge < boundary_edges; ++edge)
    if (loops.root(edge) == edge && !root_open[edge]) ++holes;
  return holes;
}

std::size_t count_shells(std::size_t facet_count, const FacetEdges& edges) {
  UnionFind shells(facet_count);
  for (std::size_t edge = 0; edge < edges.size(); ++edge)
    for (const EdgeUse& use : edges.uses(edge)) shells.unite(edges.uses(edge)[0].facet, use.facet);
  std::size_t count = 0;
  for (std::uint32_t facet = 0; facet < facet_count; ++facet)
    if (shells.root(facet) == facet) ++count;
  return count;
}

void report_edges(const FacetEdges& edges, FacetModelReport& report) {
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    const auto uses = edges.uses(edge);
    if (uses.size() == 1) ++report.boundary_edges;
    if (uses.size() == 2 && !is_manifold(uses)) ++report.inconsistent_edges;
    if (uses.size() > 2) ++report.non_manifold_edges;
  }
  report.closed = report.boundary_edges + report.inconsistent_edges + report.non_manifold_edges == 0;
}

// Connects facets that form an oriented manifold. Half-edges are laid directly, because OpenMesh's add_face
// searches around the nodes, which costs the square of the number of facets at a node (a fan of 100,000
// facets on a turned part's end face is real).
FacetMesh connect(const std::vector<Vec3>& nodes_mm, const std::vector<Nodes>& facets) {
  using Vertex = FacetMesh::VertexHandle;
  using Face = FacetMesh::FaceHandle;
  using Halfedge = FacetMesh::HalfedgeHandle;

  const FacetEdges edges(facets, nodes_mm.size());
  FacetMesh mesh;
  mesh.reserve(nodes_mm.size(), edges.size(), facets.size());
  for (const Vec3& node : nodes_mm) mesh.new_vertex({node.x(), node.y(), node.z()});

  std::vector<std::array<Halfedge, 3>> halfedges(facets.size());
  std::vector<Halfedge> rim;  // the half-edges without a facet
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    const auto uses = edges.uses(edge);
    const Nodes& nodes = facets[uses[0].facet];
    const Halfedge halfedge = mesh.new_edge(Vertex(static_cast<int>(nodes[uses[0].edge])),
                                            Vertex(static_cast<int>(nodes[(uses[0].edge + 1) % 3])));
    const Halfedge opposite = mesh.opposite_halfedge_handle(halfedge);
    halfedges[uses[0].facet][uses[0].edge] = halfedge;
    if (uses.size() == 2)
      halfedges[uses[1].facet][uses[1].edge] = opposite;
    else
      rim.push_back(opposite);
  }
  for (const auto& around : halfedges) {
    const Face face = mesh.new_face();
    mesh.set_halfedge_handle(face, around[2]);  // as in OpenMesh's own faces: circulators start at corner 0
    for (int k = 0; k < 3; ++k) {
      mesh.set_face_handle(around[k], face);
      mesh.set_next_halfedge_handle(around[k], around[(k + 1) % 3]);
      mesh.set_halfedge_handle(mesh.from_vertex_handle(around[k]), around[k]);
    }
  }
  // A node is one fan: at most one rim half-edge leaves it, and by OpenMesh's convention that is the node's
  // own.
  for (const Halfedge halfedge : rim) mesh.set_halfedge_handle(mesh.from_vertex_handle(halfedge), halfedge);
  for (const Halfedge halfedge : rim)
    mesh.set_next_halfedge_handle(halfedge, mesh.halfedge_handle(mesh.to_vertex_handle(halfedge)));
  return mesh;
}

}  // namespace

FacetModelBuild build_facet_model(const FacetSoup& soup, double weld_tolerance_mm) {
  validate(soup, weld_tolerance_mm);
  FacetModelBuild build;
  FacetModelReport& report = build.report;

  const std::vector<std::uint32_t> replacement = weld_nodes(soup.nodes_mm, weld_tolerance_mm);
  for (std::uint32_t node = 0; node < replacement.size(); ++node)
    if (replacement[node] != node) ++report.nodes_welded;

  KeptFacets kept = drop_duplicates(drop_degenerate(soup, replacement, report), report);
  if (kept.nodes.empty())
    throw InputError("all " + std::to_string(soup.facets.size()) +
                     " facets are degenerate (no area), none is left");
  const std::vector<std::uint32_t> soup_node = renumber_nodes(kept.nodes, soup.nodes_mm.size());
  report.unused_nodes_removed = soup.nodes_mm.size() - report.nodes_welded - soup_node.size();

  const FacetEdges edges(kept.nodes, soup_node.size());
  Fans fans = split_into_fans(kept.nodes, soup_node.size(), edges);
  report_edges(edges, report);
  report.holes = count_holes(fans, edges);
  report.shells = count_shells(kept.nodes.size(), edges);

  std::vector<Vec3> nodes_mm;
  nodes_mm.reserve(fans.welded_node.size());
  for (const std::uint32_t node : fans.welded_node) nodes_mm.push_back(soup.nodes_mm[soup_node[node]]);
  build.model.mesh_ = connect(nodes_mm, fans.facets);
  build.model.facets_ = std::move(fans.facets);
  build.model.welded_node_ = std::move(fans.welded_node);
  build.model.surface_of_facet_.reserve(kept.soup_facet.size());
  for (const std::uint32_t facet : kept.soup_facet)
    build.model.surface_of_facet_.push_back(soup.surface_of_facet.empty() ? 0 : soup.surface_of_facet[facet]);
  build.soup_facet = std::move(kept.soup_facet);
  return build;
}

Vec3 FacetModel::facet_normal(std::uint32_t facet) const {
  const auto [a, b, c] = corners_mm(facet);
  return triangle_area_vector(a, b, c).stableNormalized();
}

double FacetModel::area_mm2() const {
  double twice_area = 0.0;
  for (std::uint32_t facet = 0; facet < facet_count(); ++facet) {
    const auto [a, b, c] = corners_mm(facet);
    twice_area += triangle_area_vector(a, b, c).norm();
  }
  return 0.5 * twice_area;
}

double FacetModel::volume_mm3() const {
  // Tetrahedra to a point of the model, not to the origin: far from it they would cancel.
  const Vec3 apex = node_count() > 0 ? node_mm(0) : Vec3::Zero();
  double six_volumes = 0.0;
  for (std::uint32_t facet = 0; facet < facet_count(); ++facet) {
    const auto [a, b, c] = corners_mm(facet);
    six_volumes += (a - apex).dot((b - apex).cross(c - apex));
  }
  return six_volumes / 6.0;
}

Vec3 FacetModel::lower_corner_mm() const {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (std::uint32_t node = 0; node < node_count(); ++node) lower = lower.cwiseMin(node_mm(node));
  return lower;
}

Vec3 FacetModel::upper_corner_mm() const {
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());
  for (std::uint32_t node = 0; node < node_count(); ++node) upper = upper.cwiseMax(node_mm(node));
  return upper;
}

}  // namespace trueblade
