#include "part/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <ostream>

#include "part/input_file.h"

namespace trueblade {

const PlyProperty* PlyElement::find(std::string_view property) const {
  for (const PlyProperty& candidate : properties)
    if (candidate.name == property) return &candidate;
  return nullptr;
}

const PlyElement* PlyFile::find(std::string_view element) const {
  for (const PlyElement& candidate : elements)
    if (candidate.name == element) return &candidate;
  return nullptr;
}

InputError PlyFile::row_error(const PlyElement& element, std::size_t row, const std::string& message) const {
  if (!ascii)
    return file_error(path.string(), message + " (" + element.name + " " + std::to_string(row) + ")");
  std::size_t line = static_cast<std::size_t>(header_lines) + row + 1;
  for (const PlyElement& before : elements) {
    if (&before == &element) break;
    line += before.rows;
  }
  return line_error(path, static_cast<int>(line), message);
}

const PlyProperty& required_scalar(const PlyFile& ply, const PlyElement& element, const std::string& name) {
  const PlyProperty* property = element.find(name);
  if (!property || property->is_list)
    throw file_error(ply.path.string(), "element " + element.name + " has no property " + name);
  return *property;
}

namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", PlyType::int8},
                                               {"uchar", PlyType::uint8},
                                               {"short", PlyType::int16},
                                               {"ushort", PlyType::uint16},
                                               {"int", PlyType::int32},
                                               {"uint", PlyType::uint32},
                                               {"float", PlyType::float32},
                                               {"double", PlyType::float64},
                                               {"int8", PlyType::int8},
                                               {"uint8", PlyType::uint8},
                                               {"int16", PlyType::int16},
                                               {"uint16", PlyType::uint16},
                                               {"int32", PlyType::int32},
                                               {"uint32", PlyType::uint32},
                                               {"float32", PlyType::float32},
                                               {"float64", PlyType::float64}}};

// Calls `use` with a value of the C++ type behind `type`.
template <typename Use>
auto with_type(PlyType type, Use use) {
  switch (type) {
    case PlyType::int8:
      return use(std::int8_t{});
    case PlyType::uint8:
      return use(std::uint8_t{});
    case PlyType::int16:
      return use(std::int16_t{});
    case PlyType::uint16:
      return use(std::uint16_t{});
    case PlyType::int32:
      return use(std::int32_t{});
    case PlyType::uint32:
      return use(std::uint32_t{});
    case PlyType::float32:
      return use(float{});
    case PlyType::float64:
      break;
  }
  return use(double{});
}

std::size_t size_of(PlyType type) {
  return with_type(type, [](auto value) { return sizeof(value); });
}

bool is_floating(PlyType type) {
  return type == PlyType::float32 || type == PlyType::float64;
}

bool fits(PlyType type, double value) {
  return is_floating(type) || with_type(type, [value](auto sample) {
           using Limits = std::numeric_limits<decltype(sample)>;
           return value == std::floor(value) && value >= static_cast<double>(Limits::lowest()) &&
                  value <= static_cast<double>(Limits::max());
         });
}

// --- header ---------------------------------------------------------------------------------------------

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
  PlyFile ply;
  Encoding encoding = Encoding::ascii;
  std::string_view body;
};

class HeaderParser {
 public:
  HeaderParser(const std::filesystem::path& file, std::string_view bytes) : file_(file), lines_(bytes) {
    header_.ply.path = file;
  }

  Header parse() {
    std::string_view line;
    if (!lines_.next(line) || line != "ply")
      throw line_error(file_, 1, "is not a PLY file: the first line must be \"ply\"");
    parse_format();
    while (true) {
      if (!next_fields()) throw file_error(file_.string(), "is truncated: \"end_header\" is missing");
      const std::string_view keyword = fields_[0];
      if (keyword == "end_header") break;
      if (keyword == "comment")
        header_.ply.comments.emplace_back(line_.substr(std::min(line_.size(), std::size_t{8})));
      else if (keyword == "element")
        parse_element();
      else if (keyword == "property")
        parse_property();
      else if (keyword != "obj_info")
        throw error("header keyword " + in_quotes(keyword) + " is not known");
    }
    for (const PlyElement& element : header_.ply.elements)
      if (element.properties.empty()) throw error("element " + element.name + " has no property");
    header_.ply.header_lines = lines_.number();
    header_.body = lines_.rest();
    return std::move(header_);
  }

 private:
  std::filesystem::path file_;
  TextLines lines_;
  std::string_view line_;
  std::vector<std::string_view> fields_;
  Header header_;

  InputError error(const std::string& message) const { return line_error(file_, lines_.number(), message); }

  bool next_fields() {
    do {
      if (!lines_.next(line_)) return false;
      split_fields(line_, fields_);
    } while (fields_.empty());
    return true;
  }

  void parse_format() {
    if (!next_fields() || fields_.size() != 3 || fields_[0] != "format" || fields_[2] != "1.0")
      throw error("the line \"format <encoding> 1.0\" is missing");
    if (fields_[1] == "ascii")
      header_.encoding = Encoding::ascii;
    else if (fields_[1] == "binary_little_endian")
      header_.encoding = Encoding::little_endian;
    else if (fields_[1] == "binary_big_endian")
      header_.encoding = Encoding::big_endian;
    else
      throw error("encoding is " + in_quotes(fields_[1]) +
                  ", must be ascii, binary_little_endian or binary_big_endian");
    header_.ply.ascii = header_.encoding == Encoding::ascii;
  }

  void parse_element() {
    if (fields_.size() != 3) throw error("must be \"element <name> <count>\"");
    const auto count = parse_integer(fields_[2]);
    if (!count || *count < 0)
      throw error("the count of element " + std::string(fields_[1]) + " is " + in_quotes(fields_[2]) +
                  ", must be a whole number of at least 0");
    if (header_.ply.find(fields_[1])) throw error("element " + std::string(fields_[1]) + " appears twice");
    header_.ply.elements.push_back({std::string(fields_[1]), static_cast<std::size_t>(*count), {}});
  }

  PlyType parse_type(std::string_view name) const {
    for (const TypeName& known : kTypeNames)
      if (known.name == name) return known.type;
    throw error("property type " + in_quotes(name) + " is not known");
  }

  void parse_property() {
    if (header_.ply.elements.empty()) throw error("a property stands before the first element");
    PlyProperty property;
    if (fields_.size() == 5 && fields_[1] == "list") {
      property.is_list = true;
      property.count_type = parse_type(fields_[2]);
      if (is_floating(property.count_type)) throw error("the count of a list must have a whole-number type");
      property.type = parse_type(fields_[3]);
    } else if (fields_.size() == 3) {
      property.type = parse_type(fields_[1]);
    } else {
      throw error("must be \"property <type> <name>\" or \"property list <type> <type> <name>\"");
    }
    property.name = std::string(fields_.back());
    if (header_.ply.elements.back().find(property.name))
      throw error("property " + property.name + " appears twice");
    header_.ply.elements.back().properties.push_back(std::move(property));
  }
};

// --- body -----------------------------------------------------------------------------------------------

// A row takes at least this many bytes: what a header may promise is bounded by the file's size.
std::size_t least_row_bytes(const PlyElement& element, Encoding encoding) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (encoding == Encoding::ascii)
      bytes += 2;  // a digit and a separator
    else
      bytes += size_of(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

void require_room(const Header& header) {
  std::size_t left = header.body.size() + 1;  // the last line's end may be missing
  for (const PlyElement& element : header.ply.elements) {
    const std::size_t row_bytes = least_row_bytes(element, header.encoding);
    if (element.rows > left / row_bytes)
      throw file_error(header.ply.path.string(), "is truncated: its header promises " +
                                                     std::to_string(element.rows) + " rows of element " +
                                                     element.name + ", which do not fit into the file");
    left -= element.rows * row_bytes;
  }
}

void begin_values(PlyElement& element) {
  for (PlyProperty& property : element.properties) {
    property.values.reserve(element.rows);
    if (property.is_list) property.list_begin.assign(1, 0);
  }
}

void end_list(PlyProperty& property, const PlyFile& ply) {
  if (property.values.size() > std::numeric_limits<std::uint32_t>::max())
    throw file_error(ply.path.string(), "property " + property.name + " has more than 2^32 list entries");
  property.list_begin.push_back(static_cast<std::uint32_t>(property.values.size()));
}

class AsciiBody {
 public:
  explicit AsciiBody(Header& header)
      : ply_(header.ply), lines_(header.body, static_cast<std::size_t>(header.ply.header_lines) + 1) {}

  void read() {
    for (PlyElement& element : ply_.elements) {
      begin_values(element);
      for (std::size_t row = 0; row < element.rows; ++row) read_row(element, row);
    }
    for (std::string_view line; lines_.next(line);)
      if (line.find_first_not_of(" \t") != std::string_view::npos)
        throw line_error(ply_.path, lines_.number(), "data behind the last row that the header promises");
  }

 private:
  PlyFile& ply_;
  TextLines lines_;
  std::vector<std::string_view> fields_;
  std::size_t field_ = 0;

  InputError error(const std::string& message) const {
    return line_error(ply_.path, lines_.number(), message);
  }

  double take(PlyType type, const PlyProperty& property) {
    if (field_ == fields_.size()) throw error("the row ends before property " + property.name);
    const std::string_view token = fields_[field_++];
    const auto value = parse_number(token);
    if (!value) throw error("property " + property.name + " is " + in_quotes(token) + ", must be a number");
    if (!fits(type, *value))
      throw error("property " + property.name + " is " + in_quotes(token) + ", which does not fit its type");
    return *value;
  }

  void read_row(PlyElement& element, std::size_t row) {
    std::string_view line;
    if (!lines_.next(line))
      throw file_error(ply_.path.string(), "is truncated: element " + element.name + " has " +
                                               std::to_string(row) + " of " + std::to_string(element.rows) +
                                               " rows");
    split_fields(line, fields_);
    field_ = 0;
    for (PlyProperty& property : element.properties) {
      if (!property.is_list) {
        property.values.push_back(take(property.type, property));
        continue;
      }
      const double count = take(property.count_type, property);
      if (!(count >= 0)) throw error("list " + property.name + " has a negative count");
      for (double i = 0; i < count; ++i) property.values.push_back(take(property.type, property));
      end_list(property, ply_);
    }
    if (field_ != fields_.size())
      throw error("the row has more values than element " + element.name + " has properties");
  }
};

class BinaryBody {
 public:
  explicit BinaryBody(Header& header)
      : ply_(header.ply),
        body_(header.body),
        swap_((header.encoding == Encoding::big_endian) != (std::endian::native == std::endian::big)),
        header_bytes_(0) {}

  void read(std::size_t header_bytes) {
    header_bytes_ = header_bytes;
    for (PlyElement& element : ply_.elements) {
      begin_values(element);
      for (std::size_t row = 0; row < element.rows; ++row) read_row(element, row);
    }
    if (at_ != body_.size()) throw error("data behind the last row that the header promises");
  }

 private:
  PlyFile& ply_;
  std::string_view body_;
  bool swap_;
  std::size_t header_bytes_;
  std::size_t at_ = 0;

  InputError error(const std::string& message) const {
    return byte_error(ply_.path, header_bytes_ + at_, message);
  }

  void require(std::size_t bytes, const PlyElement& element, std::size_t row) const {
    if (body_.size() - at_ < bytes)
      throw error("is truncated: element " + element.name + " has " + std::to_string(row) + " of " +
                  std::to_string(element.rows) + " rows");
  }

  double take(PlyType type) {
    return with_type(type, [this](auto value) {
      std::array<char, sizeof(value)> raw;
      std::memcpy(raw.data(), body_.data() + at_, raw.size());
      at_ += raw.size();
      if (swap_) std::reverse(raw.begin(), raw.end());
      std::memcpy(&value, raw.data(), raw.size());
      return static_cast<double>(value);
    });
  }

  void read_row(PlyElement& element, std::size_t row) {
    for (PlyProperty& property : element.properties) {
      if (!property.is_list) {
        require(size_of(property.type), element, row);
        property.values.push_back(take(property.type));
        continue;
      }
      require(size_of(property.count_type), element, row);
      const double count = take(property.count_type);
      if (!(count >= 0)) throw error("list " + property.name + " has a negative count");
      const auto entries = static_cast<std::size_t>(count);
      require(entries * size_of(property.type), element, row);
      for (std::size_t i = 0; i < entries; ++i) property.values.push_back(take(property.type));
      end_list(property, ply_);
    }
  }
};

std::string_view name_of(PlyType type) {
  for (const TypeName& known : kTypeNames)
    if (known.type == type) return known.name;
  return {};
}

void put(std::ostream& stream, PlyType type, double number) {
  with_type(type, [&](auto value) {
    value = static_cast<decltype(value)>(number);
    std::array<char, sizeof(value)> raw;
    std::memcpy(raw.data(), &value, raw.size());
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    stream.write(raw.data(), raw.size());
  });
}

}  // namespace

PlyFile read_ply(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file);
  Header header = HeaderParser(file, bytes).parse();
  require_room(header);
  if (header.encoding == Encoding::ascii)
    AsciiBody(header).read();
  else
    BinaryBody(header).read(bytes.size() - header.body.size());
  return std::move(header.ply);
}

void write_ply(std::ostream& stream, const PlyFile& ply) {
  stream << "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : ply.comments) stream << "comment " << comment << '\n';
  for (const PlyElement& element : ply.elements) {
    stream << "element " << element.name << ' ' << element.rows << '\n';
    for (const PlyProperty& property : element.properties) {
      stream << "property ";
      if (property.is_list) stream << "list " << name_of(property.count_type) << ' ';
      stream << name_of(property.type) << ' ' << property.name << '\n';
    }
  }
  stream << "end_header\n";
  for (const PlyElement& element : ply.elements)
    for (std::size_t row = 0; row < element.rows; ++row)
      for (const PlyProperty& property : element.properties) {
        std::size_t begin = row, end = row + 1;
        if (property.is_list) {
          begin = property.list_begin[row];
          end = property.list_begin[row + 1];
          put(stream, property.count_type, static_cast<double>(end - begin));
        }
        for (std::size_t i = begin; i < end; ++i) put(stream, property.type, property.values[i]);
      }
}

}  // namespace trueblade
