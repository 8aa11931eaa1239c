#include "apps/run_folder.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>

#include "geometry/error.h"
#include "inspection/result_json.h"
#include "part/ply.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

void check_schema(const Json& result, const std::string& file) {
  if (!result.is_object() || !result.contains("schema") || result["schema"] != "trueblade-result" ||
      !result.contains("schema_version") || !result["schema_version"].is_number_integer())
    throw InputError(fmt::format("{}: is no result of trueblade", file));
  const int version = result["schema_version"].get<int>();
  if (version > kResultSchemaVersion)
    throw InputError(fmt::format(
        "{}: schema_version is {}, this program reads up to {}: it was written by a newer trueblade", file,
        version, kResultSchemaVersion));
  for (const char* key : {"run", "views", "profiles", "sections", "groups", "offsets", "joint", "missing"})
    if (!result.contains(key))
      throw InputError(fmt::format("{}: has no key \"{}\": make the run again", file, key));
}

std::vector<float> floats(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

}  // namespace

std::string date_now() {
  return fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)));
}

Json read_result(const std::filesystem::path& folder) {
  const std::string file = (folder / "result.json").string();
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: no such file; is this the folder of a run?", file));
  Json result;
  try {
    result = Json::parse(stream);
  } catch (const Json::exception& failure) {
    throw InputError(fmt::format("{}: {}", file, failure.what()));
  }
  check_schema(result, file);
  return result;
}

Vec3 vector_of(const Json& vector) {
  return {vector.at(0).get<double>(), vector.at(1).get<double>(), vector.at(2).get<double>()};
}

RigidTransform pose_of(const Json& pose) {
  const Json& q = pose.at("rotation_wxyz");
  RigidTransform transform;
  transform.rotation = Eigen::Quaterniond(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(),
                                          q.at(3).get<double>());
  transform.translation_mm = vector_of(pose.at("translation_mm"));
  return transform;
}

ReportCloud read_cloud(const std::filesystem::path& folder, const std::string& view) {
  const PlyFile ply = read_ply(folder / fmt::format("deviations_{}.ply", view));
  const PlyElement* vertex = ply.find("vertex");
  if (!vertex) throw InputError(fmt::format("{}: holds no vertices", ply.path.string()));
  const auto column = [&](const char* name) -> const std::vector<double>& {
    return required_scalar(ply, *vertex, name).values;
  };
  ReportCloud cloud;
  cloud.view = view;
  const std::vector<double>&x = column("x"), &y = column("y"), &z = column("z");
  for (std::size_t i = 0; i < vertex->rows; ++i)
    for (const double value : {x[i], y[i], z[i]}) cloud.position_mm.push_back(static_cast<float>(value));
  cloud.deviation_mm = floats(column("scalar_deviation"));
  cloud.snr = floats(column("scalar_snr"));
  for (const double value : column("surface")) cloud.surface.push_back(static_cast<std::uint32_t>(value));
  for (const double value : column("outlier")) cloud.outlier.push_back(value != 0.0);
  if (vertex->find("scalar_deviation_together")) {
    cloud.deviation_together = floats(column("scalar_deviation_together"));
    for (const double value : column("outlier_together")) cloud.outlier_together.push_back(value != 0.0);
  }
  return cloud;
}

}  // namespace trueblade
