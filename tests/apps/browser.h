// Pages of the program in headless Chromium.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/apps/child_process.h"

namespace trueblade {

// Whether the shell command ends with exit code 0.
bool succeeds(const std::string& command);

bool has_browser();

// Opens the page, a file of the folder, as `page#selftest` and gives what it found out about itself. A test
// failure, and null, when the page writes to the console or does not run to its end.
nlohmann::json self_test(const ScratchFolder& folder, const std::filesystem::path& page);

}  // namespace trueblade
