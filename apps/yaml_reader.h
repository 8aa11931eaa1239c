// Strict reading of YAML files; with yaml_writer.h the one door to yaml-cpp.
//
// Every defect is an InputError that names file, line and the way to the key
// (registration.rejection.cut_sigma): unknown key (with the nearest valid key and the list of valid ones),
// key given twice, wrong type, value out of range, missing key. No input exhausts memory or stack: files
// above 1 MiB, nesting deeper than 20 levels, anchors and aliases, and tags are refused.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/yaml_fields.h"

namespace trueblade {

// Reads the one document of `file`, a map, through `fields`. Throws InputError.
void read_yaml(const std::filesystem::path& file, const YamlFields::MapFunction& fields);

// A value that stands in for what the file says, or does not say. `path`: keys and list places (from 0) with
// dots between; `value`: YAML text.
struct YamlOverride {
  std::string path;
  std::string value;
};

// The same with values replaced before the fields are read, so that a path that leads to no field is an
// unknown key.
void read_yaml(const std::filesystem::path& file, const std::vector<YamlOverride>& overrides,
               const YamlFields::MapFunction& fields);

// The same for text already in memory; `file` is the name used in messages.
void read_yaml_text(const std::string& text, const std::string& file, const YamlFields::MapFunction& fields);

}  // namespace trueblade
