// LZF decompression (Lehmann's liblzf format), as PCD files use it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace trueblade {

// The `size` bytes that were compressed; nullopt when the data are damaged or hold another number of bytes.
// Never allocates more than 88 times the input: no LZF data expand further.
std::optional<std::string> lzf_decompressed(std::string_view compressed, std::size_t size);

}  // namespace trueblade
