#include "part/read_points.h"

#include "geometry/error.h"
#include "part/input_file.h"
#include "part/ply.h"
#include "part/point_file.h"

namespace trueblade {

bool names_snr(std::string_view column) {
  const std::string name = lower_case(column);
  return name == "snr" || name == "scalar_snr";
}

std::optional<std::string> defect_of(const Vec3& point, std::optional<double> snr) {
  if (!point.allFinite()) return "a coordinate is not finite";
  if (snr && !(*snr >= 0.0 && *snr <= 1.0))
    return "SNR is " + std::to_string(*snr) + ", must be within 0 and 1";
  return std::nullopt;
}

PointFile read_ply_points(const std::filesystem::path& file) {
  const PlyFile ply = read_ply(file);
  PointFile points;
  for (const std::string& comment : ply.comments)
    if (const auto unit = unit_in_comment(comment)) points.unit = unit;
  const PlyElement* vertex = ply.find("vertex");
  if (!vertex) throw file_error(file.string(), "has no element vertex");
  const auto& x = required_scalar(ply, *vertex, "x").values;
  const auto& y = required_scalar(ply, *vertex, "y").values;
  const auto& z = required_scalar(ply, *vertex, "z").values;
  for (const PlyProperty& property : vertex->properties)
    if (!property.is_list && names_snr(property.name)) points.snr = property.values;
  for (std::size_t i = 0; i < vertex->rows; ++i) {
    points.points.emplace_back(x[i], y[i], z[i]);
    const auto snr = points.snr.empty() ? std::nullopt : std::optional(points.snr[i]);
    if (const auto defect = defect_of(points.points.back(), snr)) throw ply.row_error(*vertex, i, *defect);
  }
  return points;
}

namespace {

PointFile read_by_ending(const std::filesystem::path& file) {
  const std::string ending = lower_case_ending(file);
  if (ending == ".ply") return read_ply_points(file);
  if (ending == ".pcd") return read_pcd_points(file);
  for (const char* table : {".xyz", ".asc", ".txt", ".csv"})
    if (ending == table) return read_point_table(file);
  throw file_error(file.string(), "ending " + in_quotes(ending) +
                                      " is no point format, must be .ply, .pcd, .xyz, .asc, .txt or .csv");
}

}  // namespace

ScanPoints read_points(const std::filesystem::path& file, std::optional<LengthUnit> unit) {
  PointFile points = read_by_ending(file);
  if (points.points.empty()) throw file_error(file.string(), "has no points");
  const double mm_per_unit = millimetres_per(settled_unit(file, unit, points.unit));
  for (Vec3& point : points.points) point *= mm_per_unit;
  return {std::move(points.points), std::move(points.snr)};
}

}  // namespace trueblade
