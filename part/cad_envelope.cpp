#include "part/cad_envelope.h"

#include <array>
#include <string>

#include "geometry/error.h"
#include "part/input_file.h"

namespace trueblade {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace

void check_step_envelope(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.substr(0, kByteOrderMark.size()) == kByteOrderMark) bytes.remove_prefix(kByteOrderMark.size());
  const std::string_view text = trimmed(bytes);
  if (text.substr(0, 13) != "ISO-10303-21;")
    throw line_error(file, 1, "is not a STEP file: it does not start with \"ISO-10303-21;\"");
  if (bytes.find('\0') != std::string_view::npos)
    throw byte_error(file, bytes.find('\0'), "is not a STEP file: it holds a zero byte");
  // Behind the last section some systems write a comment or a signature.
  if (text.rfind("END-ISO-10303-21;") == std::string_view::npos)
    throw file_error(file.string(), "is truncated: \"END-ISO-10303-21;\" is missing");
  if (text.find("DATA") == std::string_view::npos || text.find("ENDSEC;") == std::string_view::npos)
    throw file_error(file.string(), "is not a STEP file: it has no DATA section");
}

void check_iges_envelope(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::string_view kSections = "SGDPT";
  std::array<long long, 5> lines_of_section{};
  std::size_t section = 0;
  std::string_view terminate;
  TextLines lines(bytes);
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() && trimmed(lines.rest()).empty()) break;  // blank lines at the end
    if (line.size() < 73)
      throw line_error(file, lines.number(),
                       "is not an IGES file: the line has " + std::to_string(line.size()) +
                           " columns, must have 80 with the section letter in column 73");
    const std::size_t here = kSections.find(line[72]);
    if (here == std::string_view::npos || here < section)
      throw line_error(file, lines.number(),
                       "is not an IGES file: column 73 is " + in_quotes(line.substr(72, 1)) +
                           ", must be S, G, D, P or T, in this order");
    section = here;
    const auto number = parse_integer(trimmed(line.substr(73, 7)));
    if (number != lines_of_section[section] + 1)
      throw line_error(file, lines.number(),
                       "line number " + in_quotes(line.substr(73, 7)) + " in section " + line[72] +
                           " must be " + std::to_string(lines_of_section[section] + 1) +
                           ": lines are missing or damaged");
    ++lines_of_section[section];
    if (section == 4) terminate = line;
  }
  if (terminate.empty())
    throw file_error(file.string(), "is truncated: the terminate line (section T) is missing");
  for (std::size_t s = 0; s < 4; ++s) {
    const std::string_view count = terminate.substr(8 * s, 8);
    if (count[0] != kSections[s] || parse_integer(trimmed(count.substr(1))) != lines_of_section[s])
      throw line_error(file, lines.number(),
                       "the terminate line says " + in_quotes(count) + ", but section " + kSections[s] +
                           " has " + std::to_string(lines_of_section[s]) + " lines");
  }
}

}  // namespace trueblade
