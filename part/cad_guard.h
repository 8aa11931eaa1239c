// OpenCASCADE behind one door: it neither prints on our streams nor throws its own exceptions past us.
// For the sources of part/ that include OpenCASCADE, and nobody else.
#pragma once

#include <filesystem>
#include <functional>

namespace trueblade {

// Runs `work` with OpenCASCADE's messages discarded. What OpenCASCADE throws becomes an InputError that names
// `file` and says that it `could not be <doing>`: "read", "faceted". One call at a time: its readers keep
// global state.
void with_cad_kernel(const std::filesystem::path& file, const char* doing, const std::function<void()>& work);

}  // namespace trueblade
