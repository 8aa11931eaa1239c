// A part or a scan where a command takes a YAML file: a slip of a newcomer, who is told what the file is and
// what takes it, not that it is bad YAML.
#pragma once

#include <filesystem>
#include <string>

namespace trueblade {

// Goes by the ending of a file that exists. `wanted`: "a scenario", "a study". Throws InputError.
void refuse_part_or_scan(const std::filesystem::path& file, const std::string& wanted);

}  // namespace trueblade
