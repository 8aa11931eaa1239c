#include <cmath>
#include <map>

#include "part/assemble_part.h"
#include "part/ply.h"
#include "part/read_mesh.h"

namespace trueblade {

namespace {

std::vector<Vec3> nodes_mm(const PlyFile& ply, std::optional<LengthUnit> unit) {
  std::optional<LengthUnit> stated;
  for (const std::string& comment : ply.comments)
    if (const auto found = unit_in_comment(comment)) stated = found;
  const double mm_per_unit = millimetres_per(settled_unit(ply.path, unit, stated));
  const PlyElement* vertex = ply.find("vertex");
  if (!vertex) throw file_error(ply.path.string(), "has no element vertex");
  const auto& x = required_scalar(ply, *vertex, "x").values;
  const auto& y = required_scalar(ply, *vertex, "y").values;
  const auto& z = required_scalar(ply, *vertex, "z").values;
  std::vector<Vec3> nodes(vertex->rows);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i] = mm_per_unit * Vec3(x[i], y[i], z[i]);
    if (!nodes[i].allFinite()) throw ply.row_error(*vertex, i, "a coordinate is not finite");
  }
  return nodes;
}

const PlyProperty& node_lists(const PlyFile& ply, const PlyElement& face) {
  for (const char* name : {"vertex_indices", "vertex_index"})
    if (const PlyProperty* property = face.find(name); property && property->is_list) return *property;
  throw file_error(ply.path.string(), "element face has no list vertex_indices");
}

}  // namespace

Part read_ply_mesh(const std::filesystem::path& file, std::optional<LengthUnit> unit) {
  const PlyFile ply = read_ply(file);
  FacetSoup soup;
  soup.nodes_mm = nodes_mm(ply, unit);
  const PlyElement* face = ply.find("face");
  if (!face || face->rows == 0) throw file_error(file.string(), "has no facets");
  const PlyProperty& lists = node_lists(ply, *face);
  const PlyProperty* surface = face->find("surface");

  std::map<double, std::uint32_t> surface_number;  // by the file's number, in its order
  if (surface)
    for (const double id : surface->values) surface_number.emplace(id, 0);
  std::vector<PartSurface> surfaces;
  for (auto& [id, number] : surface_number) {
    number = static_cast<std::uint32_t>(surfaces.size());
    surfaces.push_back({"surface_" + std::to_string(static_cast<long long>(id)), "facets", 0, 0.0});
  }
  if (surfaces.empty()) surfaces.push_back({"surface_0", "facets", 0, 0.0});

  for (std::size_t row = 0; row < face->rows; ++row) {
    const std::size_t begin = lists.list_begin[row], corners = lists.list_begin[row + 1] - begin;
    if (corners < 3)
      throw ply.row_error(*face, row,
                          "the face has " + std::to_string(corners) + " corners, must have 3 or more");
    for (std::size_t k = 0; k < corners; ++k)
      if (const double node = lists.values[begin + k];
          !(node >= 0 && node < static_cast<double>(soup.nodes_mm.size()) && node == std::floor(node)))
        throw ply.row_error(*face, row,
                            "vertex number " + std::to_string(static_cast<long long>(node)) +
                                " must be at least 0 and below " + std::to_string(soup.nodes_mm.size()));
    const auto node = [&](std::size_t k) { return static_cast<std::uint32_t>(lists.values[begin + k]); };
    for (std::size_t k = 2; k < corners; ++k) {
      soup.facets.push_back({node(0), node(k - 1), node(k)});
      if (surface) soup.surface_of_facet.push_back(surface_number.at(surface->values[row]));
    }
  }
  return assemble_part(file.stem().string(), soup, std::move(surfaces), {});
}

}  // namespace trueblade
