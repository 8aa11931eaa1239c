// Reading whole files and the numbers in them, with errors that say where.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/error.h"

namespace trueblade {

// All bytes of a regular file. Throws InputError when it is missing, a folder or a device, unreadable, or
// empty.
std::string read_file_bytes(const std::filesystem::path& file);

// The ending in lower case, with its dot: ".stp".
std::string lower_case_ending(const std::filesystem::path& file);

std::string lower_case(std::string_view text);

// The whole token as a number (a leading '+' is allowed); nullopt when it is none or out of range. "nan" and
// "inf" are numbers here: the caller knows which error they deserve.
std::optional<double> parse_number(std::string_view token);
std::optional<long long> parse_integer(std::string_view token);

// Lines of a text in memory, counted from 1; ends in LF, CR LF or CR.
class TextLines {
 public:
  explicit TextLines(std::string_view text, std::size_t first_line = 1)
      : rest_(text), next_number_(first_line) {}

  bool next(std::string_view& line);                                 // false at the end of the text
  int number() const { return static_cast<int>(next_number_ - 1); }  // of the line last returned
  std::string_view rest() const { return rest_; }                    // the bytes behind that line

 private:
  std::string_view rest_;
  std::size_t next_number_;
};

// Splits at blanks and tabs.
void split_fields(std::string_view line, std::vector<std::string_view>& fields);

// Splits at every `separator` ("1,,2" has an empty field) and trims blanks and tabs around each field.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& fields);

// "name:line: message" and the part of a token that fits into a message.
InputError line_error(const std::filesystem::path& file, int line, const std::string& message);
InputError byte_error(const std::filesystem::path& file, std::size_t offset, const std::string& message);
std::string in_quotes(std::string_view token);

}  // namespace trueblade
