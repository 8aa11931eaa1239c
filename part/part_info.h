// What `trueblade part info` says about a part, as numbers, as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "part/part.h"

namespace trueblade {

struct PartInfo {
  std::string name;
  std::vector<PartSurface> surfaces;
  std::size_t facets = 0, nodes = 0;
  Vec3 lower_corner_mm, upper_corner_mm;  // bounding box
  double area_mm2 = 0.0;
  std::optional<double> volume_mm3;  // of a closed part
  FacetModelReport report;
  std::size_t surfaces_without_facets = 0;  // faces that the kernel could not facet: holes in the part
  // Largest distance between facets and exact surfaces; nullopt for a part that has none.
  std::optional<double> chord_error_mm;
};

PartInfo part_info(const Part& part);

std::string to_text(const PartInfo& info);  // several lines, for a person
nlohmann::ordered_json to_json(const PartInfo& info);

}  // namespace trueblade
