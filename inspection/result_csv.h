// Tables of a result for spreadsheets: comma-separated, one heading line, lengths in mm, angles in rad,
// numbers that do not exist empty.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace trueblade {

// From a result.json of the present schema: one row per view and one per view and CAD surface (its surface
// column is empty for the view as a whole).
std::string statistics_csv(const nlohmann::ordered_json& result);

// Section features, profiles and the components of pose differences: kind, where, name, unit, nominal,
// measured, deviation, standard uncertainty, method or decision.
std::string features_csv(const nlohmann::ordered_json& result);

}  // namespace trueblade
