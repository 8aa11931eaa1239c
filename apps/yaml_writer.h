// Writing of structs as YAML that reads back to the same struct (see yaml_fields.h).
#pragma once

#include <filesystem>
#include <string>

#include "apps/yaml_fields.h"

namespace trueblade {

std::string yaml_text(const YamlFields::MapFunction& fields);

// As a file that appears whole or not at all. Throws InputError as write_file_atomically does.
void write_yaml(const std::filesystem::path& file, const YamlFields::MapFunction& fields);

}  // namespace trueblade
