// Numbers as bytes, little endian, for the records of journals and of the sample stream.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace trueblade {

static_assert(std::endian::native == std::endian::little, "records are written as the memory holds them");

template <class Number>
void append_bytes(std::string& out, Number value) {
  static_assert(std::is_arithmetic_v<Number>);
  char bytes[sizeof(Number)];
  std::memcpy(bytes, &value, sizeof(Number));
  out.append(bytes, sizeof(Number));
}

// Takes numbers from the front of a record that someone else wrote: past its end every read fails, and goes
// on failing.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class Number>
  Number take() {
    static_assert(std::is_arithmetic_v<Number>);
    Number value{};
    if (bytes_.size() < sizeof(Number)) {
      failed_ = true;
      bytes_ = {};
      return value;
    }
    std::memcpy(&value, bytes_.data(), sizeof(Number));
    bytes_.remove_prefix(sizeof(Number));
    return value;
  }
  std::string_view rest() const { return bytes_; }
  bool failed() const { return failed_; }
  bool finished() const { return !failed_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool failed_ = false;
};

// CRC-32 (ISO 3309, as in zlib) of the bytes.
std::uint32_t crc32_of(std::string_view bytes);

}  // namespace trueblade
