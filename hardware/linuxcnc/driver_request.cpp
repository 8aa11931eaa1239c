#include "hardware/linuxcnc/driver_request.h"

#include <array>
#include <charconv>
#include <utility>

#include "hardware/bytes.h"

namespace trueblade {
namespace {

using Kind = DriverRequest::Kind;

std::optional<Kind> request_of_one_word(std::string_view line) {
  constexpr std::array<std::pair<std::string_view, Kind>, 6> words{{{"samples", Kind::samples},
                                                                    {"quiet", Kind::quiet},
                                                                    {"watch", Kind::watch},
                                                                    {"alive", Kind::alive},
                                                                    {"release", Kind::release},
                                                                    {"hold", Kind::hold}}};
  for (const auto& [word, kind] : words)
    if (line == word) return kind;
  return std::nullopt;
}

// Nothing but decimal digits, and no number beyond its type.
template <class Number>
bool read_number(std::string_view digits, Number& value) {
  const char* end = digits.data() + digits.size();
  const auto [stopped_at, failure] = std::from_chars(digits.data(), end, value);
  return failure == std::errc{} && stopped_at == end;
}

}  // namespace

std::optional<DriverRequestReader::Announced> DriverRequestReader::announced_by(std::string_view line) {
  constexpr std::string_view word = "program ";
  if (!line.starts_with(word)) return std::nullopt;
  line.remove_prefix(word.size());
  const std::size_t blank = line.find(' ');
  Announced program;
  if (blank == std::string_view::npos || !read_number(line.substr(0, blank), program.bytes) ||
      !read_number(line.substr(blank + 1), program.checksum))
    return std::nullopt;
  return program;
}

void DriverRequestReader::feed(std::string_view bytes) {
  if (fault_.empty()) pending_ += bytes;
}

// What was taken is dropped here and not request by request, so that many short lines cost no quadratic
// copying.
std::nullopt_t DriverRequestReader::wait() {
  pending_.erase(0, taken_);
  taken_ = 0;
  return std::nullopt;
}

std::nullopt_t DriverRequestReader::end_with(std::string_view fault) {
  fault_ = fault;
  pending_.clear();
  taken_ = 0;
  return std::nullopt;
}

std::optional<DriverRequest> DriverRequestReader::next() {
  if (!fault_.empty()) return std::nullopt;
  if (!program_) {
    const std::string_view bytes = std::string_view(pending_).substr(taken_);
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos && bytes.size() <= kLongestLine) return wait();
    if (end > kLongestLine) return end_with("a line is too long");  // npos is, too
    const std::string_view line = bytes.substr(0, end);
    taken_ += end + 1;
    if (const auto kind = request_of_one_word(line)) return DriverRequest{*kind, {}};
    program_ = announced_by(line);
    if (!program_) return end_with("a line is no request");
    if (program_->bytes > kLongestProgram) return end_with("a program is too long");
  }
  const std::string_view bytes = std::string_view(pending_).substr(taken_);
  if (bytes.size() < program_->bytes) return wait();
  DriverRequest request{Kind::program, std::string(bytes.substr(0, program_->bytes))};
  if (crc32_of(request.program) != program_->checksum) return end_with("the checksum of a program is wrong");
  taken_ += program_->bytes;
  program_.reset();
  return request;
}

}  // namespace trueblade
