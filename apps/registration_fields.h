// The registration block of a scenario, and the whole of an options file for `trueblade register`.
#pragma once

#include <filesystem>
#include <string>

#include "apps/yaml_fields.h"
#include "registration/options.h"

namespace trueblade {

struct RegistrationSpec {
  std::string preset = "default";
  RegistrationOptions options;  // the preset's, with what the file says otherwise
};

void fields(YamlFields& io, RegistrationSpec& spec);

// Reads a file that holds nothing but these fields. Throws InputError naming file and line.
RegistrationSpec read_registration_options(const std::filesystem::path& file);

}  // namespace trueblade
