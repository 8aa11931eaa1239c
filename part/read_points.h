// Point files of other systems and our own scans, as registration needs them: positions and, where present,
// SNR.
#pragma once

#include <filesystem>
#include <optional>

#include "geometry/scan_points.h"
#include "part/length_unit.h"

namespace trueblade {

// Reads PLY (ascii, binary little and big endian; range_grid files too), XYZ/ASC/TXT/CSV (with or without an
// SNR column) or PCD (ascii, binary). `unit` is required unless the file says it (our own scans do, by the
// comment "unit mm"). Throws InputError naming file, line and reason; positions must be finite, SNR within
// [0, 1].
ScanPoints read_points(const std::filesystem::path& file, std::optional<LengthUnit> unit);

}  // namespace trueblade
