// What a CAD exchange file must look like from outside before the CAD kernel may see it: the right format,
// and whole. The kernel accepts truncated files and reads what is left of the part without a word.
#pragma once

#include <filesystem>
#include <string_view>

namespace trueblade {

// ISO 10303-21: "ISO-10303-21;" ... HEADER ... DATA ... ENDSEC; ... "END-ISO-10303-21;".
void check_step_envelope(const std::filesystem::path& file, std::string_view bytes);

// IGES 5.3, fixed format: lines of 80 columns, section letter in column 73, numbered within each section S,
// G, D, P, T; the terminate line counts the lines of the other sections.
void check_iges_envelope(const std::filesystem::path& file, std::string_view bytes);

}  // namespace trueblade
