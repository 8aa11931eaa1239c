#include "part/facet_cad_shape.h"

#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "part/cad_guard.h"
#include "part/cad_surfaces.h"
#include "part/refine_facets.h"

namespace trueblade {

namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& same_node, std::uint32_t node) {
  while (same_node[node] != node) node = same_node[node] = same_node[same_node[node]];
  return node;
}

void join(std::vector<std::uint32_t>& same_node, std::uint32_t a, std::uint32_t b) {
  a = root_of(same_node, a);
  b = root_of(same_node, b);
  same_node[std::max(a, b)] = std::min(a, b);
}

void mesh_shape(const CadShape& cad, const std::filesystem::path& file, const FacetingOptions& options) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(cad.shape, box, Standard_False, Standard_False);
  const double diagonal_mm = box.IsVoid() ? 0.0 : std::sqrt(box.SquareExtent());
  // A facet on radius R with chord error c is sqrt(8 R c) wide: at c = 1e-6 of the part's size a part has
  // millions of facets, below it faceting would eat the machine's memory.
  constexpr double kFinestChordToSize = 1e-6;
  if (!(diagonal_mm > 0.0) || box.IsOpen() || !std::isfinite(diagonal_mm))
    throw file_error(file.string(), "has no finite extent");
  if (options.chord_tolerance_mm < kFinestChordToSize * diagonal_mm)
    throw file_error(file.string(), "chord_tolerance_mm is " + std::to_string(options.chord_tolerance_mm) +
                                        ", must be at least a millionth of the part's diagonal of " +
                                        std::to_string(diagonal_mm) + " mm");
  IMeshTools_Parameters parameters;
  parameters.Deflection = options.chord_tolerance_mm;
  parameters.Angle = options.angular_tolerance_rad;
  parameters.InParallel = Standard_True;
  BRepMesh_IncrementalMesh(cad.shape, parameters);
}

Vec3 vector_from(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}

// Gathers the facets of all faces. Every node first stays on its own face; a union-find forest joins the
// nodes that are one on the part.
class FaceCollector {
 public:
  CadFacets mesh;

  void add(const TopoDS_Face& face, std::uint32_t surface) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull() || !triangulation->HasUVNodes())
      return;  // reported as a surface without facets
    const auto first = static_cast<std::uint32_t>(mesh.nodes_mm.size());
    add_nodes(*triangulation, location.Transformation());
    // A mirroring placement turns the facets over as well.
    const bool reversed = (face.Orientation() == TopAbs_REVERSED) != location.Transformation().IsNegative();
    for (int t = 1; t <= triangulation->NbTriangles(); ++t) {
      std::array<int, 3> corner{};
      triangulation->Triangle(t).Get(corner[0], corner[1], corner[2]);
      if (reversed) std::swap(corner[1], corner[2]);
      std::array<std::uint32_t, 3> nodes{};
      std::array<Vec2, 3> parameters;
      for (std::size_t k = 0; k < 3; ++k) {
        nodes[k] = first + static_cast<std::uint32_t>(corner[k] - 1);
        const gp_Pnt2d uv = triangulation->UVNode(corner[k]);
        parameters[k] = {uv.X(), uv.Y()};
      }
      mesh.facets.push_back(nodes);
      mesh.surface_of_facet.push_back(surface);
      mesh.corner_parameters.push_back(parameters);
    }
    for (TopExp_Explorer each(face, TopAbs_EDGE); each.More(); each.Next())
      join_along(TopoDS::Edge(each.Current()), triangulation, location, first);
  }

  // Gives every facet the first of the nodes that are one.
  void unite_nodes() {
    for (auto& nodes : mesh.facets)
      for (auto& node : nodes) node = root_of(same_node_, node);
  }

 private:
  std::vector<std::uint32_t> same_node_;
  // The nodes of an edge as the first face that has it numbers them.
  TopTools_DataMapOfShapeInteger edge_number_;
  std::vector<std::vector<std::uint32_t>> nodes_of_edge_;
  TopTools_DataMapOfShapeInteger node_of_vertex_;

  void add_nodes(const Poly_Triangulation& triangulation, const gp_Trsf& placement) {
    for (int n = 1; n <= triangulation.NbNodes(); ++n) {
      same_node_.push_back(static_cast<std::uint32_t>(mesh.nodes_mm.size()));
      mesh.nodes_mm.push_back(vector_from(triangulation.Node(n).Transformed(placement)));
    }
  }

  void join_along(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangulation,
                  const TopLoc_Location& location, std::uint32_t first) {
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
    if (polygon.IsNull()) return;
    std::vector<std::uint32_t> nodes;
    for (int n = 1; n <= polygon->NbNodes(); ++n)
      nodes.push_back(first + static_cast<std::uint32_t>(polygon->Node(n) - 1));
    if (nodes.empty()) return;
    join_at_vertices(edge, nodes);
    if (BRep_Tool::Degenerated(edge)) {  // a pole: one point of the part
      for (const std::uint32_t node : nodes) join(same_node_, nodes.front(), node);
      return;
    }
    if (!edge_number_.IsBound(edge)) {
      edge_number_.Bind(edge, static_cast<int>(nodes_of_edge_.size()));
      nodes_of_edge_.push_back(nodes);
      return;
    }
    const auto& known = nodes_of_edge_[static_cast<std::size_t>(edge_number_.Find(edge))];
    if (known.size() != nodes.size()) return;  // left open, and reported as such
    for (std::size_t i = 0; i < nodes.size(); ++i) join(same_node_, known[i], nodes[i]);
  }

  void join_at_vertices(const TopoDS_Edge& edge, const std::vector<std::uint32_t>& nodes) {
    // The polygon runs along the edge's curve, whatever the edge's orientation in this face.
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    join_at_vertex(TopExp::FirstVertex(forward), nodes.front());
    join_at_vertex(TopExp::LastVertex(forward), nodes.back());
  }

  void join_at_vertex(const TopoDS_Vertex& vertex, std::uint32_t node) {
    if (vertex.IsNull()) return;
    if (node_of_vertex_.IsBound(vertex))
      join(same_node_, static_cast<std::uint32_t>(node_of_vertex_.Find(vertex)), node);
    else
      node_of_vertex_.Bind(vertex, static_cast<int>(node));
  }
};

}  // namespace

CadFacets facet_cad_shape(const CadShape& cad, const std::filesystem::path& file,
                          const FacetingOptions& options) {
  options.validate();
  FaceCollector collector;
  with_cad_kernel(file, "faceted", [&] {
    mesh_shape(cad, file, options);
    for (std::size_t i = 0; i < cad.faces.size(); ++i) {
      collector.add(cad.faces[i], static_cast<std::uint32_t>(i));
      collector.mesh.surfaces.push_back({cad.names[i].empty() ? "surface_" + std::to_string(i) : cad.names[i],
                                         surface_kind(cad.faces[i]), 0, 0.0});
    }
    collector.mesh.exact = make_exact_surfaces(cad.faces, options.chord_tolerance_mm);
  });
  if (collector.mesh.facets.empty()) throw file_error(file.string(), "none of its surfaces could be faceted");
  collector.unite_nodes();
  collector.mesh.chord_tolerance_mm = options.chord_tolerance_mm;
  refine_facets(collector.mesh);
  return std::move(collector.mesh);
}

}  // namespace trueblade
