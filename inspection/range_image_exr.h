// OpenEXR file of a range image: one float32 channel per quantity, lossless. The one place that includes
// OpenEXR.
#pragma once

#include <filesystem>

#include "inspection/range_image.h"

namespace trueblade {

// Attributes: units, frames, view, program, scenario, seed (text), part_from_mcs (4 x 4 of doubles, row
// vectors as in all of OpenEXR: p' = p M, translation in the last row) and part_from_mcs_wxyz_mm (text with
// 17 digits: rotation w x y z, translation). Throws InputError when the file cannot be written or the image
// is empty.
void write_range_image_exr(const std::filesystem::path& file, const RangeImage& image);

// Throws InputError naming the file when it is missing, no OpenEXR, truncated, damaged, not written by
// trueblade, or larger than a scan can be.
RangeImage read_range_image_exr(const std::filesystem::path& file);

}  // namespace trueblade
