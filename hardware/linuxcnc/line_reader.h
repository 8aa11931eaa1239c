// Cuts what arrives from a connection, in whatever pieces, into lines of bounded length.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

namespace trueblade {

class LineReader {
 public:
  // The longest reply of linuxcncrsh that is asked for here is below 200 bytes.
  static constexpr std::size_t kLongestLine = 1024;

  void feed(std::string_view bytes);
  // The next whole line without its end (any run of CR and LF; empty lines are left out). A line that is too
  // long, or holds bytes that no text has, comes as one line "?": it is no valid reply, and memory stays
  // bounded whatever arrives.
  std::optional<std::string> next();

 private:
  std::deque<std::string> lines_;  // whole ones
  std::string arriving_;
  bool spoilt_ = false;  // the line that is arriving
};

}  // namespace trueblade
