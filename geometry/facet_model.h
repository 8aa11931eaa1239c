// The facet model of a part (paper, Table 1): nodes with their neighbour nodes and facets, facets with their
// nodes counter-clockwise seen from outside, the mesh. OpenMesh keeps the topology; nodes are shared across
// the borders of CAD surfaces, and every facet knows the CAD surface it came from. Coordinates in mm in the
// part frame (PCS).
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// Facets as a reader delivers them: nodes may repeat, facets may be degenerate, nothing is connected yet.
struct FacetSoup {
  std::vector<Vec3> nodes_mm;
  std::vector<std::array<std::uint32_t, 3>> facets;  // node numbers, counter-clockwise seen from outside
  std::vector<std::uint32_t> surface_of_facet;       // one per facet, or empty: all on surface 0
};

struct FacetMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(0);
  FaceAttributes(0);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using FacetMesh = OpenMesh::TriMesh_ArrayKernelT<FacetMeshTraits>;

// What was found and repaired while the model was built.
struct FacetModelReport {
  std::size_t nodes_welded = 0;        // nodes of the soup that were merged into another
  std::size_t degenerate_removed = 0;  // facets with fewer than three different nodes, or zero area
  std::size_t duplicate_removed = 0;   // facets with the same three nodes as an earlier one
  std::size_t unused_nodes_removed = 0;
  std::size_t boundary_edges = 0;      // edges with one facet
  std::size_t holes = 0;               // closed loops of boundary edges; an open sheet's rim is one
  std::size_t non_manifold_edges = 0;  // edges with three or more facets
  std::size_t inconsistent_edges =
      0;                   // edges whose two facets run in the same direction (orientation disagrees)
  std::size_t shells = 0;  // components connected through edges
  bool closed = false;     // no boundary, non-manifold or inconsistent edge
};

struct FacetModelBuild;

class FacetModel {
 public:
  std::size_t node_count() const { return mesh_.n_vertices(); }
  std::size_t facet_count() const { return mesh_.n_faces(); }

  Vec3 node_mm(std::uint32_t node) const {
    const auto& p = mesh_.point(FacetMesh::VertexHandle(static_cast<int>(node)));
    return {p[0], p[1], p[2]};
  }
  const std::array<std::uint32_t, 3>& facet_nodes(std::uint32_t facet) const { return facets_[facet]; }
  std::array<Vec3, 3> corners_mm(std::uint32_t facet) const {
    const auto& n = facets_[facet];
    return {node_mm(n[0]), node_mm(n[1]), node_mm(n[2])};
  }
  std::uint32_t surface_of(std::uint32_t facet) const { return surface_of_facet_[facet]; }
  Vec3 facet_normal(std::uint32_t facet) const;  // unit, outward

  // Nodes that were doubled because no two-manifold joins their facets lie at one place: the number of that
  // place, from 0, the same for all of them. Equal to `node` where nothing was doubled.
  std::uint32_t welded_node(std::uint32_t node) const { return welded_node_[node]; }

  // Neighbour iteration (Table 1) through OpenMesh circulators; vertex/face handle idx() are node/facet
  // numbers.
  const FacetMesh& mesh() const { return mesh_; }

  double area_mm2() const;
  double volume_mm3() const;     // meaningful when closed
  Vec3 lower_corner_mm() const;  // bounding box
  Vec3 upper_corner_mm() const;

 private:
  friend FacetModelBuild build_facet_model(const FacetSoup&, double);
  FacetMesh mesh_;
  std::vector<std::array<std::uint32_t, 3>>
      facets_;  // the mesh's own connectivity, flat for the search structures
  std::vector<std::uint32_t> surface_of_facet_;
  std::vector<std::uint32_t> welded_node_;
};

struct FacetModelBuild {
  FacetModel model;
  std::vector<std::uint32_t> soup_facet;  // for each facet of the model, its number in the soup
  FacetModelReport report;
};

// Welds nodes that lie within `weld_tolerance_mm` of an earlier node that kept its place (0: only equal ones;
// see weld_nodes.h), removes degenerate and duplicate facets, and connects the rest. A facet has zero area
// when its height is below four ulps of its coordinates. Where facets meet in a way that no oriented
// two-manifold allows (edges with three facets, edges whose facets disagree, fans that touch in a node), the
// nodes there are doubled so that every facet is kept; the report counts on the welded nodes, before
// doubling. Facet numbers follow the soup's order; so do node numbers, with the doubles at the end. Cost n
// log n. Throws InputError when a coordinate is not finite or beyond 1e9 mm, a node number is out of range,
// the tolerance is negative, surface_of_facet has another length than facets, or no facet is left.
FacetModelBuild build_facet_model(const FacetSoup& soup, double weld_tolerance_mm);

}  // namespace trueblade
