#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include "part/assemble_part.h"
#include "part/input_file.h"
#include "part/read_mesh.h"

namespace trueblade {

namespace {

constexpr std::size_t kHeaderBytes = 84;  // 80 of text, 4 of facet count
constexpr std::size_t kFacetBytes = 50;   // 12 floats and 2 bytes of attributes

std::uint32_t little_endian_32(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

std::size_t binary_size(std::string_view bytes) {
  return kHeaderBytes + kFacetBytes * std::size_t{little_endian_32(bytes.data() + 80)};
}

bool is_text(std::string_view bytes) {
  for (const char c : bytes.substr(0, 512))
    if (!std::isprint(static_cast<unsigned char>(c)) && !std::isspace(static_cast<unsigned char>(c)))
      return false;
  return true;
}

void add_facet(FacetSoup& soup, const std::array<Vec3, 3>& corners_mm, std::uint32_t surface) {
  const auto first = static_cast<std::uint32_t>(soup.nodes_mm.size());
  soup.nodes_mm.insert(soup.nodes_mm.end(), corners_mm.begin(), corners_mm.end());
  soup.facets.push_back({first, first + 1, first + 2});
  soup.surface_of_facet.push_back(surface);
}

Part read_binary(const std::filesystem::path& file, std::string_view bytes, double mm_per_unit) {
  if (bytes.size() < kHeaderBytes)
    throw file_error(file.string(),
                     "is no STL file: it is neither text that starts with \"solid\" nor binary");
  const std::size_t count = little_endian_32(bytes.data() + 80);
  if (bytes.size() != binary_size(bytes))
    throw file_error(file.string(), "is no whole STL file: its facet count of " + std::to_string(count) +
                                        " asks for " + std::to_string(binary_size(bytes)) +
                                        " bytes, but it has " + std::to_string(bytes.size()));
  if (count == 0) throw file_error(file.string(), "has no facets");
  FacetSoup soup;
  for (std::size_t facet = 0; facet < count; ++facet) {
    const std::size_t at = kHeaderBytes + facet * kFacetBytes;
    std::array<Vec3, 3> corners_mm;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        corners_mm[k][static_cast<int>(axis)] =
            mm_per_unit * std::bit_cast<float>(little_endian_32(bytes.data() + at + 12 * (k + 1) + 4 * axis));
      if (!corners_mm[k].allFinite())
        throw byte_error(file, at, "facet " + std::to_string(facet) + ": a coordinate is not finite");
    }
    add_facet(soup, corners_mm, 0);
  }
  return assemble_part(file.stem().string(), soup, {{"surface_0", "facets", 0, 0.0}}, {});
}

class AsciiStl {
 public:
  AsciiStl(const std::filesystem::path& file, std::string_view bytes, double mm_per_unit)
      : file_(file), lines_(bytes), mm_per_unit_(mm_per_unit) {}

  Part read() {
    while (next_line()) read_solid();
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

  InputError error(const std::string& message) const { return line_error(file_, lines_.number(), message); }

  // The next line that is not blank.
  bool next_line() {
    std::string_view line;
    do {
      if (!lines_.next(line)) return false;
      split_fields(line, fields_);
    } while (fields_.empty());
    return true;
  }

  void require_line() {
    if (!next_line()) throw file_error(file_.string(), "is truncated: \"endsolid\" is missing");
  }

  bool line_starts_with(std::string_view keyword) const {
    return fields_[0].size() == keyword.size() &&
           std::equal(keyword.begin(), keyword.end(), fields_[0].begin(), [](char a, char b) {
             return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
           });
  }

  void require_keyword(std::string_view keyword) const {
    if (!line_starts_with(keyword))
      throw error("\"" + std::string(keyword) + "\" must stand here, not " + in_quotes(fields_[0]));
  }

  void read_solid() {
    require_keyword("solid");
    const auto surface = static_cast<std::uint32_t>(surfaces_.size());
    surfaces_.push_back({fields_.size() > 1 ? std::string(fields_[1]) : "surface_" + std::to_string(surface),
                         "facets", 0, 0.0});
    for (require_line(); !line_starts_with("endsolid"); require_line()) {
      require_keyword("facet");
      require_line();
      require_keyword("outer");
      std::array<Vec3, 3> corners_mm;
      for (Vec3& corner_mm : corners_mm) corner_mm = read_corner();
      require_line();
      require_keyword("endloop");
      require_line();
      require_keyword("endfacet");
      add_facet(soup_, corners_mm, surface);
    }
  }

  Vec3 read_corner() {
    require_line();
    require_keyword("vertex");
    if (fields_.size() != 4) throw error("must be \"vertex x y z\"");
    Vec3 corner;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = fields_[static_cast<std::size_t>(axis) + 1];
      const auto value = parse_number(token);
      if (!value) throw error("coordinate " + in_quotes(token) + " is not a number");
      corner[axis] = mm_per_unit_ * *value;
    }
    if (!corner.allFinite()) throw error("a coordinate is not finite");
    return corner;
  }
};

}  // namespace

Part read_stl(const std::filesystem::path& file, LengthUnit unit) {
  const std::string bytes = read_file_bytes(file);
  const bool right_size = bytes.size() >= kHeaderBytes && bytes.size() == binary_size(bytes);
  if (!right_size && is_text(bytes)) return AsciiStl(file, bytes, millimetres_per(unit)).read();
  return read_binary(file, bytes, millimetres_per(unit));
}

}  // namespace trueblade
