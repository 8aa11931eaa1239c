// result.json: the machine-readable result of a run.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "inspection/result.h"

namespace trueblade {

// Raised when a key is renamed, removed or changes its meaning; new keys alone do not raise it.
inline constexpr int kResultSchemaVersion = 1;

// The document, described by docs/result.schema.json. Numbers that do not exist are null.
nlohmann::ordered_json result_json(const InspectionResult& result);

// Throws InputError when the file cannot be written.
void write_result_json(const std::filesystem::path& file, const InspectionResult& result);

}  // namespace trueblade
