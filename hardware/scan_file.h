// A measured view on disk: PLY, binary little endian, opened by CloudCompare and MeshLab without help.
//
//   element vertex         the usable samples: x y z (double, mm, MCS), snr, quality, x_axis y_axis z_axis
//                          (mm), theta (rad), distance (mm), time (s), flags, cell, sample
//   element lost_sample    the samples without a usable distance: the same columns but x y z and quality
//
// `cell` is row * columns + column of the organised grid, `sample` the number in the order taken, so that
// nothing of a ViewScan is lost. `quality` repeats the SNR under the name that MeshLab shows. The header's
// comments carry unit, view and grid. Columns in docs/formats.md.
#pragma once

#include <filesystem>
#include <string>

#include "hardware/scan_plan.h"

namespace trueblade {

// Writes the file whole or not at all. Throws InputError when the folder cannot be written.
void write_scan(const std::filesystem::path& file, const ViewScan& scan);

// Reads back what write_scan wrote, bit by bit. Scans of other systems are read by part/read_points.h.
// Throws InputError naming the file and what is wrong with it.
ViewScan read_scan(const std::filesystem::path& file);

// The same from the bytes of such a file; `name` stands for the file in error messages.
ViewScan read_scan_bytes(const std::string& bytes, const std::string& name);

}  // namespace trueblade
