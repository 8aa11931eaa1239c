#include "part/lzf.h"

namespace trueblade {

std::optional<std::string> lzf_decompressed(std::string_view compressed, std::size_t size) {
  // The best case is a back reference: 3 bytes become 2 + 7 + 255 = 264.
  if (size / 88 > compressed.size()) return std::nullopt;
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto take = [&] { return std::size_t{static_cast<unsigned char>(compressed[at++])}; };
  while (at < compressed.size()) {
    const std::size_t control = take();
    if (control < 32) {  // the next control + 1 bytes as they are
      if (compressed.size() - at < control + 1 || size - out.size() < control + 1) return std::nullopt;
      out.append(compressed.substr(at, control + 1));
      at += control + 1;
      continue;
    }
    // A back reference: three bits of length, or seven and another byte; thirteen bits of offset.
    std::size_t length = (control >> 5) + 2;
    if (compressed.size() - at < (length == 9 ? 2U : 1U)) return std::nullopt;
    if (length == 9) length += take();
    const std::size_t offset = ((control & 31) << 8 | take()) + 1;
    if (offset > out.size() || size - out.size() < length) return std::nullopt;
    // Byte by byte: the source may overlap what is being written.
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - offset]);
  }
  if (out.size() != size) return std::nullopt;
  return out;
}

}  // namespace trueblade
