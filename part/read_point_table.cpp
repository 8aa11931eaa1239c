#include <algorithm>
#include <array>

#include "part/input_file.h"
#include "part/point_file.h"

namespace trueblade {

namespace {

constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

struct Columns {
  std::array<std::size_t, 3> xyz{0, 1, 2};
  std::size_t snr = kNoColumn;
  std::size_t count = 0;
};

// The separator that a line uses. A semicolon wins over a comma, so that a decimal comma becomes an error and
// not two numbers.
char separator_of(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  return line.find(',') != std::string_view::npos ? ',' : ' ';
}

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  if (separator == ' ')
    split_fields(line, fields);
  else
    split_at(line, separator, fields);
}

// The columns that a header line names; nullopt when it does not name x, y and z.
std::optional<Columns> columns_named(const std::vector<std::string_view>& names) {
  Columns columns;
  columns.count = names.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char name = "xyz"[axis];
    const auto found = std::find_if(names.begin(), names.end(), [name](std::string_view candidate) {
      return lower_case(candidate) == std::string(1, name);
    });
    if (found == names.end()) return std::nullopt;
    columns.xyz[axis] = static_cast<std::size_t>(found - names.begin());
  }
  const auto snr = std::find_if(names.begin(), names.end(), names_snr);
  if (snr != names.end()) columns.snr = static_cast<std::size_t>(snr - names.begin());
  return columns;
}

// Without a header: x y z, and a fourth column alone is the SNR. More columns are colours or normals.
Columns columns_of_numbers(std::size_t count) {
  Columns columns;
  columns.count = count;
  if (count == 4) columns.snr = 3;
  return columns;
}

std::size_t comment_mark(std::string_view line) {
  if (line.substr(0, 1) == "#") return 1;
  return line.substr(0, 2) == "//" ? 2 : 0;
}

class TableReader {
 public:
  TableReader(const std::filesystem::path& file, std::string_view bytes) : file_(file), lines_(bytes) {}

  PointFile read() {
    for (std::string_view line; lines_.next(line);) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
      if (line.empty()) continue;
      if (const std::size_t mark = comment_mark(line))
        read_comment(line.substr(mark));
      else if (!columns_)
        read_first_line(line);
      else
        read_point(line);
    }
    return std::move(points_);
  }

 private:
  std::filesystem::path file_;
  TextLines lines_;
  std::optional<Columns> columns_;
  char separator_ = ' ';
  std::vector<std::string_view> fields_;
  PointFile points_;

  InputError error(const std::string& message) const { return line_error(file_, lines_.number(), message); }

  void read_comment(std::string_view comment) {
    if (const auto unit = unit_in_comment(comment)) points_.unit = unit;
    if (columns_) return;
    split(comment, separator_of(comment), fields_);  // "//X,Y,Z,SNR" is how some systems write a header
    columns_ = columns_named(fields_);
  }

  void read_first_line(std::string_view line) {
    split(line, separator_of(line), fields_);
    if (parse_number(fields_[0])) {
      columns_ = columns_of_numbers(fields_.size());
      read_point(line);
      return;
    }
    columns_ = columns_named(fields_);
    if (!columns_)
      throw error("must be three numbers or a header that names x, y and z, not " + in_quotes(line));
  }

  double number(std::size_t column, const char* name) const {
    const auto value = parse_number(fields_[column]);
    if (!value) throw error(std::string(name) + " is " + in_quotes(fields_[column]) + ", must be a number");
    return *value;
  }

  void read_point(std::string_view line) {
    if (points_.points.empty()) separator_ = separator_of(line);
    split(line, separator_, fields_);
    if (fields_.size() < 3) throw error("must hold x y z, not " + in_quotes(line));
    if (fields_.size() != columns_->count)
      throw error("has " + std::to_string(fields_.size()) + " columns, must have " +
                  std::to_string(columns_->count) + " as the lines before");
    const Vec3 point(number(columns_->xyz[0], "x"), number(columns_->xyz[1], "y"),
                     number(columns_->xyz[2], "z"));
    std::optional<double> snr;
    if (columns_->snr != kNoColumn) points_.snr.push_back(*(snr = number(columns_->snr, "SNR")));
    if (const auto defect = defect_of(point, snr)) throw error(*defect);
    points_.points.push_back(point);
  }
};

}  // namespace

PointFile read_point_table(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file);
  return TableReader(file, bytes).read();
}

}  // namespace trueblade
