#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "part/input_file.h"
#include "part/lzf.h"
#include "part/point_file.h"

namespace trueblade {

namespace {

struct PcdField {
  std::string name;
  std::size_t bytes = 0;  // of one value
  char type = 'F';        // F float, I signed, U unsigned
  std::size_t values = 1;
  std::size_t row_offset = 0;  // of the field in a row of bytes
  std::size_t column = 0;      // of the field in a row of text
};

enum class Encoding { ascii, binary, binary_compressed };

struct Layout {
  std::vector<PcdField> fields;
  std::size_t row_bytes = 0, row_values = 0;
  std::size_t points = 0;
  bool organised = false;  // a grid, where a cell without a return holds NaN
  Encoding encoding = Encoding::ascii;
  std::array<const PcdField*, 3> xyz{};
  const PcdField* snr = nullptr;
};

class PcdReader {
 public:
  PcdReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes), lines_(bytes) {}

  PointFile read() {
    read_header();
    if (layout_.encoding == Encoding::ascii)
      read_ascii();
    else
      read_binary();
    return std::move(points_);
  }

 private:
  std::filesystem::path file_;
  std::string_view bytes_;
  TextLines lines_;
  std::vector<std::string_view> words_;
  Layout layout_;
  PointFile points_;

  InputError error(const std::string& message) const { return line_error(file_, lines_.number(), message); }

  // --- header -------------------------------------------------------------------------------------------

  std::size_t count(std::string_view token, const char* what, std::size_t most) const {
    const auto value = parse_integer(token);
    if (!value || *value < 0 || static_cast<std::size_t>(*value) > most)
      throw error(std::string(what) + " is " + in_quotes(token) + ", must be a whole number from 0 to " +
                  std::to_string(most));
    return static_cast<std::size_t>(*value);
  }

  void require_one_per_field() const {
    if (layout_.fields.empty() || words_.size() != layout_.fields.size() + 1)
      throw error(std::string(words_[0]) + " must have one entry per field of FIELDS");
  }

  void read_header() {
    constexpr std::size_t kMostPoints = 4'000'000'000;
    std::optional<std::size_t> width, height, points;
    for (bool in_header = true; in_header;) {
      std::string_view line;
      if (!lines_.next(line))
        throw file_error(file_.string(), "is no whole PCD file: the DATA line is missing");
      if (line.substr(0, 1) == "#") {
        if (const auto unit = unit_in_comment(line.substr(1))) points_.unit = unit;
        continue;
      }
      split_fields(line, words_);
      if (words_.empty()) continue;
      if (words_[0] == "FIELDS") {
        layout_.fields.clear();
        for (std::size_t i = 1; i < words_.size(); ++i) layout_.fields.push_back({std::string(words_[i])});
      } else if (words_[0] == "SIZE") {
        require_one_per_field();
        for (std::size_t i = 1; i < words_.size(); ++i)
          layout_.fields[i - 1].bytes = count(words_[i], "SIZE", 8);
      } else if (words_[0] == "TYPE") {
        require_one_per_field();
        for (std::size_t i = 1; i < words_.size(); ++i) layout_.fields[i - 1].type = words_[i][0];
      } else if (words_[0] == "COUNT") {
        require_one_per_field();
        for (std::size_t i = 1; i < words_.size(); ++i)
          layout_.fields[i - 1].values = count(words_[i], "COUNT", 1'000'000);
      } else if (words_[0] == "WIDTH" && words_.size() == 2) {
        width = count(words_[1], "WIDTH", kMostPoints);
      } else if (words_[0] == "HEIGHT" && words_.size() == 2) {
        height = count(words_[1], "HEIGHT", kMostPoints);
      } else if (words_[0] == "POINTS" && words_.size() == 2) {
        points = count(words_[1], "POINTS", kMostPoints);
      } else if (words_[0] == "DATA" && words_.size() == 2) {
        in_header = false;
      } else if (words_[0] != "VERSION" && words_[0] != "VIEWPOINT") {
        throw error("header keyword " + in_quotes(words_[0]) + " is not one of a PCD file");
      }
    }
    if (words_[1] == "ascii")
      layout_.encoding = Encoding::ascii;
    else if (words_[1] == "binary")
      layout_.encoding = Encoding::binary;
    else if (words_[1] == "binary_compressed")
      layout_.encoding = Encoding::binary_compressed;
    else
      throw error("DATA is " + in_quotes(words_[1]) + ", must be ascii, binary or binary_compressed");
    if (!points && !(width && height)) throw error("POINTS is missing");
    if (width && height && points && (*height == 0 || *points / *height != *width || *points % *height != 0))
      throw error("POINTS must be WIDTH times HEIGHT");
    layout_.points = points ? *points : *width * *height;
    layout_.organised = height && *height > 1;
    place_fields();
  }

  void place_fields() {
    for (PcdField& field : layout_.fields) {
      const bool known = (field.type == 'F' && (field.bytes == 4 || field.bytes == 8)) ||
                         ((field.type == 'I' || field.type == 'U') && std::has_single_bit(field.bytes));
      if (!known)
        throw error("field " + field.name + " has type " + field.type + " of " + std::to_string(field.bytes) +
                    " bytes, which is no number");
      field.row_offset = layout_.row_bytes;
      field.column = layout_.row_values;
      layout_.row_bytes += field.bytes * field.values;
      layout_.row_values += field.values;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) layout_.xyz[axis] = field_named(std::string(1, "xyz"[axis]));
    for (const PcdField& field : layout_.fields)
      if (names_snr(field.name) && field.values == 1) layout_.snr = &field;
  }

  const PcdField* field_named(const std::string& name) const {
    for (const PcdField& field : layout_.fields)
      if (field.name == name && field.values == 1) return &field;
    throw error("FIELDS has no single " + name);
  }

  // --- data ---------------------------------------------------------------------------------------------

  template <typename Error>
  void add(const Vec3& point, std::optional<double> snr, const Error& point_error) {
    if (layout_.organised && point.array().isNaN().all()) return;
    if (const auto defect = defect_of(point, snr)) throw point_error(*defect);
    points_.points.push_back(point);
    if (snr) points_.snr.push_back(*snr);
  }

  void read_ascii() {
    std::size_t row = 0;
    for (std::string_view line; lines_.next(line);) {
      split_fields(line, words_);
      if (words_.empty()) continue;
      if (row++ == layout_.points) throw error("data behind the last point that the header promises");
      if (words_.size() != layout_.row_values)
        throw error("has " + std::to_string(words_.size()) + " values, must have " +
                    std::to_string(layout_.row_values));
      const auto number = [&](const PcdField& field) {
        const auto value = parse_number(words_[field.column]);
        if (!value) throw error(field.name + " is " + in_quotes(words_[field.column]) + ", must be a number");
        return *value;
      };
      add({number(*layout_.xyz[0]), number(*layout_.xyz[1]), number(*layout_.xyz[2])},
          layout_.snr ? std::optional(number(*layout_.snr)) : std::nullopt,
          [this](const std::string& message) { return error(message); });
    }
    if (row != layout_.points)
      throw file_error(file_.string(), "is truncated: " + std::to_string(row) + " of " +
                                           std::to_string(layout_.points) + " points are there");
  }

  void read_binary() {
    std::string_view data = lines_.rest();
    const std::size_t promised = layout_.points * layout_.row_bytes;
    const bool overflows = layout_.points > static_cast<std::size_t>(-1) / layout_.row_bytes;
    std::string decompressed;
    const bool by_field = layout_.encoding == Encoding::binary_compressed;
    if (by_field && !overflows) {
      decompressed = decompressed_data(data, promised);
      data = decompressed;
    }
    if (overflows || data.size() < promised)
      throw file_error(file_.string(), "is truncated: its " + std::to_string(layout_.points) +
                                           " points do not fit into the " + std::to_string(data.size()) +
                                           " bytes behind the header");
    for (std::size_t row = 0; row < layout_.points; ++row) {
      const auto number = [&](const PcdField& field) {
        // Compressed data hold all values of a field together.
        const std::size_t at = by_field ? field.row_offset * layout_.points + row * field.bytes
                                        : row * layout_.row_bytes + field.row_offset;
        return value_at(data.data() + at, field);
      };
      add({number(*layout_.xyz[0]), number(*layout_.xyz[1]), number(*layout_.xyz[2])},
          layout_.snr ? std::optional(number(*layout_.snr)) : std::nullopt, [&](const std::string& message) {
            return file_error(file_.string(), message + " (point " + std::to_string(row) + ")");
          });
    }
  }

  std::string decompressed_data(std::string_view data, std::size_t promised) const {
    constexpr std::size_t kSizes = 8;  // compressed and original size, 4 bytes each
    if (data.size() < kSizes)
      throw file_error(file_.string(), "is truncated: the compressed data are missing");
    const std::uint32_t compressed = unsigned_at(data.data(), 4), original = unsigned_at(data.data() + 4, 4);
    data.remove_prefix(kSizes);
    if (data.size() < compressed || original != promised)
      throw file_error(file_.string(),
                       "is truncated or damaged: the compressed data have another size than "
                       "the header says");
    const auto bytes = lzf_decompressed(data.substr(0, compressed), promised);
    if (!bytes) throw file_error(file_.string(), "the compressed data are damaged");
    return *bytes;
  }

  static std::uint64_t unsigned_at(const char* bytes, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  }

  static double value_at(const char* bytes, const PcdField& field) {
    const std::uint64_t raw = unsigned_at(bytes, field.bytes);
    if (field.type == 'F')
      return field.bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(raw))
                              : std::bit_cast<double>(raw);
    if (field.type == 'U') return static_cast<double>(raw);
    const std::uint64_t sign = std::uint64_t{1} << (8 * field.bytes - 1);
    return static_cast<double>(static_cast<std::int64_t>((raw ^ sign) - sign));  // sign extension
  }
};

}  // namespace

PointFile read_pcd_points(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file);
  return PcdReader(file, bytes).read();
}

}  // namespace trueblade
