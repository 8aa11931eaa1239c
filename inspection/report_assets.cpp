#include "inspection/report_assets.h"

// The assembler copies the files as they are; a string literal of a megabyte would cost the compiler seconds
// and every quote an escape. The paths are defined by CMake.
#define TRUEBLADE_ASSET(name, path)                                                   \
  asm(".pushsection .rodata\n.balign 16\ntrueblade_asset_" #name ":\n.incbin \"" path \
      "\"\ntrueblade_asset_" #name "_end:\n.byte 0\n.popsection\n");                  \
  extern "C" const char trueblade_asset_##name[];                                     \
  extern "C" const char trueblade_asset_##name##_end[];                               \
  namespace trueblade {                                                               \
  std::string_view name() {                                                           \
    return {trueblade_asset_##name, trueblade_asset_##name##_end};                    \
  }                                                                                   \
  }

TRUEBLADE_ASSET(report_css, TRUEBLADE_REPORT_FOLDER "/report.css")
TRUEBLADE_ASSET(report_page, TRUEBLADE_REPORT_FOLDER "/page.html")
TRUEBLADE_ASSET(report_js, TRUEBLADE_REPORT_FOLDER "/report.js")
TRUEBLADE_ASSET(three_js, TRUEBLADE_THREE_JS)
TRUEBLADE_ASSET(orbit_controls_js, TRUEBLADE_ORBIT_CONTROLS_JS)
