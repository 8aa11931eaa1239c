// FNV-1a, 64 bits (Fowler, Noll, Vo): a digest that tells texts and records apart. It withstands no attacker.
#pragma once

#include <cstdint>
#include <string_view>

namespace trueblade {

inline constexpr std::uint64_t kFnv1aBasis = 0xcbf29ce484222325u;

// The digest of what `digest` stands for followed by `bytes`: pieces in turn give the digest of the whole.
constexpr std::uint64_t fnv1a(std::string_view bytes, std::uint64_t digest = kFnv1aBasis) {
  for (const char byte : bytes) digest = (digest ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  return digest;
}

}  // namespace trueblade
