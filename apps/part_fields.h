// The part block of a scenario: a file, or a demonstration part with its parameters.
#pragma once

#include <filesystem>
#include <string>

#include "apps/yaml_fields.h"
#include "part/demonstration_parts.h"
#include "part/part.h"

namespace trueblade {

enum class Demonstration { none, turbine_blade, formed_part, reference_sphere };

struct PartSpec {
  std::filesystem::path file;  // empty for a demonstration part
  std::string origin;          // where the file comes from, for who does not have it
  Demonstration demonstration = Demonstration::none;
  TurbineBladeParameters turbine_blade;
  FormedPartParameters formed_part;
  ReferenceSphereParameters reference_sphere;
  PartOptions options;
};

// Paths are relative to `folder`, that of the YAML file, and absolute once read.
void fields(YamlFields& io, PartSpec& part, const std::filesystem::path& folder);

// The parameters alone, also of `trueblade part make --parameters FILE`.
void fields(YamlFields& io, TurbineBladeParameters& blade, const std::filesystem::path& folder);
void fields(YamlFields& io, FormedPartParameters& formed);
void fields(YamlFields& io, ReferenceSphereParameters& sphere);

// Reads or builds the part. Throws InputError.
Part make_part(const PartSpec& spec);

// The demonstration part's name or the file's, for tables and captions.
std::string title_of(const PartSpec& spec);

}  // namespace trueblade
