#include "part/input_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

namespace trueblade {

std::string read_file_bytes(const std::filesystem::path& file) {
  std::error_code reason;
  const auto status = std::filesystem::status(file, reason);
  if (!std::filesystem::exists(status)) throw file_error(file.string(), "no such file");
  if (!std::filesystem::is_regular_file(status)) throw file_error(file.string(), "is not a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw file_error(file.string(), std::string("cannot be read: ") + std::strerror(errno));
  const auto size = std::filesystem::file_size(file, reason);
  if (reason) throw file_error(file.string(), "cannot be read: " + reason.message());
  if (size == 0) throw file_error(file.string(), "is empty");
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size)
    throw file_error(file.string(), "cannot be read to its end");
  return bytes;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string lower_case_ending(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

namespace {

template <typename Number>
std::optional<Number> parse_whole(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  Number value{};
  const auto [end, reason] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (reason != std::errc() || end != token.data() + token.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> parse_number(std::string_view token) {
  return parse_whole<double>(token);
}
std::optional<long long> parse_integer(std::string_view token) {
  return parse_whole<long long>(token);
}

bool TextLines::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find_first_of("\r\n");
  line = rest_.substr(0, end);
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    const bool two_bytes = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
    rest_.remove_prefix(end + (two_bytes ? 2 : 1));
  }
  ++next_number_;
  return true;
}

namespace {
constexpr std::string_view kBlanks = " \t";
}

void split_fields(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;
       begin = line.find_first_not_of(kBlanks, begin)) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end;
  }
}

void split_at(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    std::string_view field = line.substr(begin, end - begin);
    field.remove_prefix(std::min(field.find_first_not_of(kBlanks), field.size()));
    field = field.substr(0, field.find_last_not_of(kBlanks) + 1);
    fields.push_back(field);
    begin = end + 1;
  }
}

InputError line_error(const std::filesystem::path& file, int line, const std::string& message) {
  return line_error(file.string(), line, message);
}

InputError byte_error(const std::filesystem::path& file, std::size_t offset, const std::string& message) {
  return file_error(file.string(), message + " (at byte " + std::to_string(offset) + ")");
}

std::string in_quotes(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string text = "\"";
  for (const char c : token.substr(0, kLongest))
    text += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  return text + (token.size() > kLongest ? "...\"" : "\"");
}

}  // namespace trueblade
