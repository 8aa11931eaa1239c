// What an inspection leaves in its run folder, read back.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "geometry/rigid_transform.h"
#include "inspection/report_html.h"

namespace trueblade {

// The date of a run, UTC, as result.json states it (ISO 8601).
std::string date_now();

// result.json of the folder. Throws InputError naming the file when it is missing, no JSON, no result of
// trueblade, or of a newer schema than this program knows.
nlohmann::ordered_json read_result(const std::filesystem::path& folder);

// A vector and a pose of result.json.
Vec3 vector_of(const nlohmann::ordered_json& vector);
RigidTransform pose_of(const nlohmann::ordered_json& pose);

// The points of deviations_<view>.ply. Throws InputError naming the file when it is missing or damaged.
ReportCloud read_cloud(const std::filesystem::path& folder, const std::string& view);

}  // namespace trueblade
