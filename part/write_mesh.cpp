#include "part/write_mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>

#include "geometry/atomic_file.h"
#include "part/input_file.h"
#include "part/ply.h"

namespace trueblade {

namespace {

void write_ply_mesh(const Part& part, std::ostream& stream) {
  const auto scalar = [](const char* name, PlyType type) {
    return PlyProperty{name, type, false, type, {}, {}};
  };
  PlyProperty x = scalar("x", PlyType::float64), y = scalar("y", PlyType::float64);
  PlyProperty z = scalar("z", PlyType::float64), surface = scalar("surface", PlyType::int32);
  PlyProperty indices{"vertex_indices", PlyType::int32, true, PlyType::uint8, {}, {0}};
  for (std::uint32_t node = 0; node < part.model.node_count(); ++node) {
    const Vec3 p = part.model.node_mm(node);
    x.values.push_back(p.x());
    y.values.push_back(p.y());
    z.values.push_back(p.z());
  }
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    for (const std::uint32_t node : part.model.facet_nodes(facet)) indices.values.push_back(node);
    indices.list_begin.push_back(static_cast<std::uint32_t>(indices.values.size()));
    surface.values.push_back(part.model.surface_of(facet));
  }
  PlyFile ply;
  ply.comments = {"trueblade part", "unit mm"};
  ply.elements.push_back({"vertex", part.model.node_count(), {x, y, z}});
  ply.elements.push_back({"face", part.model.facet_count(), {indices, surface}});
  write_ply(stream, ply);
}

void put_little_endian(std::ostream& stream, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) stream.put(static_cast<char>(value >> shift & 0xff));
}

void put_floats(std::ostream& stream, const Vec3& v) {
  for (int axis = 0; axis < 3; ++axis)
    put_little_endian(stream, std::bit_cast<std::uint32_t>(static_cast<float>(v[axis])));
}

void write_stl(const Part& part, std::ostream& stream) {
  std::string header = "trueblade part, mm";  // must not start with "solid"
  header.resize(80, ' ');
  stream << header;
  put_little_endian(stream, static_cast<std::uint32_t>(part.model.facet_count()));
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    put_floats(stream, part.model.facet_normal(facet));
    for (const Vec3& corner_mm : part.model.corners_mm(facet)) put_floats(stream, corner_mm);
    stream.write("\0\0", 2);
  }
}

std::string one_word(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isspace(c) || c == '#'; }, '_');
  return name;
}

void write_obj(const Part& part, std::ostream& stream) {
  stream << "# trueblade part, mm\n";
  for (std::uint32_t node = 0; node < part.model.node_count(); ++node) {
    const Vec3 p = part.model.node_mm(node);
    stream << fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  }
  std::uint32_t group = static_cast<std::uint32_t>(part.surfaces.size());  // none yet
  for (std::uint32_t facet = 0; facet < part.model.facet_count(); ++facet) {
    if (const std::uint32_t surface = part.model.surface_of(facet); surface != group) {
      group = surface;
      stream << "g " << one_word(part.surfaces[group].name) << '\n';
    }
    const auto& nodes = part.model.facet_nodes(facet);
    stream << fmt::format("f {} {} {}\n", nodes[0] + 1, nodes[1] + 1, nodes[2] + 1);
  }
}

}  // namespace

void write_mesh(const Part& part, const std::filesystem::path& file) {
  const std::string ending = lower_case_ending(file);
  void (*write)(const Part&, std::ostream&) = nullptr;
  if (ending == ".ply") write = write_ply_mesh;
  if (ending == ".stl") write = write_stl;
  if (ending == ".obj") write = write_obj;
  if (!write)
    throw file_error(file.string(),
                     "ending " + in_quotes(ending) + " is no mesh format, must be .ply, .stl or .obj");
  write_file_atomically(file, [&](std::ostream& stream) { write(part, stream); });
}

}  // namespace trueblade
