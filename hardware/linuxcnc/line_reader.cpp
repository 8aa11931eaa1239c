#include "hardware/linuxcnc/line_reader.h"

namespace trueblade {
namespace {

bool ends_line(char byte) {
  return byte == '\r' || byte == '\n';
}

bool is_text(char byte) {
  return static_cast<unsigned char>(byte) >= 0x20 || byte == '\t';
}

}  // namespace

void LineReader::feed(std::string_view bytes) {
  for (const char byte : bytes) {
    if (ends_line(byte)) {
      if (spoilt_) arriving_ = "?";
      if (!arriving_.empty()) lines_.push_back(std::move(arriving_));
      arriving_.clear();
      spoilt_ = false;
    } else if (!is_text(byte) || arriving_.size() == kLongestLine) {
      spoilt_ = true;
    } else if (!spoilt_) {
      arriving_ += byte;
    }
  }
}

std::optional<std::string> LineReader::next() {
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

}  // namespace trueblade
