// TRUEBLADE_EMBED(name, path) defines `std::string_view trueblade::name()`, the bytes of the file, carried by
// the program. Use it at global scope in a source file; `path` is a string literal that CMake gives.
//
// The assembler copies the file as it is; a string literal of a megabyte would cost the compiler seconds and
// every quote an escape.
#pragma once

#include <string_view>

#define TRUEBLADE_EMBED(name, path)                                                      \
  asm(".pushsection .rodata\n.balign 16\ntrueblade_embedded_" #name ":\n.incbin \"" path \
      "\"\ntrueblade_embedded_" #name "_end:\n.byte 0\n.popsection\n");                  \
  extern "C" const char trueblade_embedded_##name[];                                     \
  extern "C" const char trueblade_embedded_##name##_end[];                               \
  namespace trueblade {                                                                  \
  std::string_view name() {                                                              \
    return {trueblade_embedded_##name, trueblade_embedded_##name##_end};                 \
  }                                                                                      \
  }
