#include <algorithm>
#include <array>
#include <map>

#include "part/assemble_part.h"
#include "part/input_file.h"
#include "part/read_mesh.h"

namespace trueblade {

namespace {

// Keywords of the format that say nothing about facets: texture, normals, materials, lines, points, display.
constexpr std::array<std::string_view, 13> kPassedOver{
    "vt", "vn", "vp", "s", "l", "p", "mg", "usemtl", "mtllib", "bevel", "lod", "shadow_obj", "usemap"};

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, std::string_view bytes, double mm_per_unit)
      : file_(file), lines_(bytes), mm_per_unit_(mm_per_unit) {}

  Part read() {
    for (std::string_view line; lines_.next(line);) {
      split_fields(line.substr(0, line.find('#')), fields_);
      if (fields_.empty()) continue;
      const std::string_view keyword = fields_[0];
      if (keyword == "v")
        read_node();
      else if (keyword == "f")
        read_face();
      else if (keyword == "g" || keyword == "o")
        group_ = fields_.size() > 1 ? std::string(fields_[1]) : std::string();
      else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) == kPassedOver.end())
        throw error("keyword " + in_quotes(keyword) + " is not one of an OBJ file of facets");
    }
    if (soup_.facets.empty()) throw file_error(file_.string(), "has no facets");
    return assemble_part(file_.stem().string(), soup_, std::move(surfaces_), {});
  }

 private:
  std::filesystem::path file_;
  TextLines lines_;
  double mm_per_unit_;
  std::vector<std::string_view> fields_;
  FacetSoup soup_;
  std::vector<PartSurface> surfaces_;
  std::string group_;
  std::map<std::string, std::uint32_t> surface_of_group_;

  InputError error(const std::string& message) const { return line_error(file_, lines_.number(), message); }

  void read_node() {
    // x y z, and perhaps a weight or a colour behind them.
    if (fields_.size() < 4 || fields_.size() > 8) throw error("must be \"v x y z\"");
    Vec3 node;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = fields_[static_cast<std::size_t>(axis) + 1];
      const auto value = parse_number(token);
      if (!value) throw error("coordinate " + in_quotes(token) + " is not a number");
      node[axis] = mm_per_unit_ * *value;
    }
    if (!node.allFinite()) throw error("a coordinate is not finite");
    soup_.nodes_mm.push_back(node);
  }

  std::uint32_t node_number(std::string_view corner) const {
    const auto nodes = static_cast<long long>(soup_.nodes_mm.size());
    const std::string_view token = corner.substr(0, corner.find('/'));
    const auto number = parse_integer(token);
    if (!number) throw error("vertex number " + in_quotes(token) + " is not a whole number");
    if (*number == 0 || *number > nodes || *number < -nodes)
      throw error("vertex number " + in_quotes(token) + " must be within 1 and " + std::to_string(nodes) +
                  " or count back with -1 to -" + std::to_string(nodes));
    return static_cast<std::uint32_t>(*number > 0 ? *number - 1 : nodes + *number);
  }

  void read_face() {
    if (fields_.size() < 4)
      throw error("the face has " + std::to_string(fields_.size() - 1) + " corners, must have 3 or more");
    const auto [known, is_new] =
        surface_of_group_.emplace(group_, static_cast<std::uint32_t>(surfaces_.size()));
    if (is_new)
      surfaces_.push_back(
          {group_.empty() ? "surface_" + std::to_string(surfaces_.size()) : group_, "facets", 0, 0.0});
    const std::uint32_t first = node_number(fields_[1]);
    std::uint32_t previous = node_number(fields_[2]);
    for (std::size_t k = 3; k < fields_.size(); ++k) {
      const std::uint32_t node = node_number(fields_[k]);
      soup_.facets.push_back({first, previous, node});
      soup_.surface_of_facet.push_back(known->second);
      previous = node;
    }
  }
};

}  // namespace

Part read_obj(const std::filesystem::path& file, LengthUnit unit) {
  const std::string bytes = read_file_bytes(file);
  return ObjReader(file, bytes, millimetres_per(unit)).read();
}

}  // namespace trueblade
