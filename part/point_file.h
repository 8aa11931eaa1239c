// Points as a file delivers them, in the file's unit, before they become a scan.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/vector.h"
#include "part/length_unit.h"

namespace trueblade {

struct PointFile {
  std::vector<Vec3> points;
  std::vector<double> snr;         // one per point, or empty
  std::optional<LengthUnit> unit;  // when the file says it
};

// The readers behind read_points, one per format. They throw InputError as it does.
PointFile read_ply_points(const std::filesystem::path& file);
PointFile read_pcd_points(const std::filesystem::path& file);
PointFile read_point_table(const std::filesystem::path& file);

// True for the column names that mean SNR: "snr", and "scalar_snr" as CloudCompare writes it, in either case.
bool names_snr(std::string_view column);

// What is wrong with a point or an SNR; nullopt: nothing.
std::optional<std::string> defect_of(const Vec3& point, std::optional<double> snr);

}  // namespace trueblade
