// Writing of structs as YAML that reads back to the same struct (see yaml_fields.h).
#pragma once

#include <string>

#include "apps/yaml_fields.h"

namespace trueblade {

std::string yaml_text(const YamlFields::MapFunction& fields);

}  // namespace trueblade
