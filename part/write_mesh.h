// The facet model of a part as a mesh file for other programs.
#pragma once

#include <filesystem>

#include "part/part.h"

namespace trueblade {

// The ending decides, coordinates are in mm:
//   .ply  binary, double; face property `surface`; the header says "comment unit mm". Read back without loss.
//   .stl  binary, float: coordinates are rounded to 24 bits (6e-6 mm at 100 mm)
//   .obj  text, shortest form that reads back without loss; one group per surface
// Throws InputError for another ending or a folder that cannot be written.
void write_mesh(const Part& part, const std::filesystem::path& file);

}  // namespace trueblade
