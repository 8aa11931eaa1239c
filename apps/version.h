// What program this is. The definitions are generated at build time (cmake/Version.cmake).
#pragma once

#include <string>

namespace trueblade {

std::string program_version();  // "0.1.0"
std::string program_commit();   // of the source, "-dirty" when it had changes; "unknown" outside git

}  // namespace trueblade
