// The reading of a CAD file in a process of its own. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <filesystem>
#include <functional>

#include "part/cad_shape.h"

namespace trueblade {

// Runs `read` in a forked child and hands its result over, bit by bit the same. OpenCASCADE follows the
// references of a damaged file without looking whether they lead anywhere: a changed character in one STEP
// file in three ends in a memory fault, which no exception reports. In a child it ends the child, and the
// caller gets an InputError that names `file`; so does a child that computes for longer than
// half a minute and half a minute per MB.
// Exceptions of `read` arrive as InputError. Call it within `with_cad_kernel`.
CadShape read_in_own_process(const std::filesystem::path& file, const std::function<CadShape()>& read);

}  // namespace trueblade
