// Writes a CAD shape as STEP. For the sources of part/ that include OpenCASCADE.
#pragma once

#include "part/cad_shape.h"

namespace trueblade {

// AP214, mm, faces named. The same shape gives the same bytes: the header carries no time of writing. Throws
// InputError when the file cannot be written.
void write_step_shape(const CadShape& cad, const std::string& product,
                      const std::filesystem::path& step_file);

}  // namespace trueblade
