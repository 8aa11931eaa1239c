// PLY files (Turk 1994): ascii, binary little and big endian, any elements and properties.
//
// The reader is strict: every row that the header promises must be there, complete, and nothing behind the
// last one. Errors name the line (ascii) or the byte (binary). A header cannot make it allocate more than a
// small multiple of the file's size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/error.h"

namespace trueblade {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float64;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  // of a list

  // A scalar has one value per row. A list has the values of all rows one after another; those of row i are
  // values[list_begin[i]] up to values[list_begin[i + 1]].
  std::vector<double> values;
  std::vector<std::uint32_t> list_begin;
};

struct PlyElement {
  std::string name;
  std::size_t rows = 0;
  std::vector<PlyProperty> properties;

  const PlyProperty* find(std::string_view property) const;  // nullptr when there is none
};

struct PlyFile {
  std::filesystem::path path;
  std::vector<std::string> comments;
  std::vector<PlyElement> elements;
  bool ascii = false;
  int header_lines = 0;

  const PlyElement* find(std::string_view element) const;

  // The error of one value: "file:line: ..." in ascii, where a row is a line, "file: ... (vertex 17)" in
  // binary.
  InputError row_error(const PlyElement& element, std::size_t row, const std::string& message) const;
};

PlyFile read_ply(const std::filesystem::path& file);

// The scalar property of that name. Throws InputError when the element has none.
const PlyProperty& required_scalar(const PlyFile& ply, const PlyElement& element, const std::string& name);

// Writes the comments and elements as binary little endian. Values must fit their types.
void write_ply(std::ostream& stream, const PlyFile& ply);

}  // namespace trueblade
