// Result files appear whole or not at all: they are written under a temporary name beside the target and
// renamed.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace trueblade {

// Calls `write` with a binary stream on a temporary file beside `target`, flushes it to disk and renames it
// to `target`. Throws InputError naming the path and the system's reason when the folder cannot be written or
// the disk is full; then `target` is untouched and the temporary file is removed.
void write_file_atomically(const std::filesystem::path& target,
                           const std::function<void(std::ostream&)>& write);

void write_text_atomically(const std::filesystem::path& target, const std::string& text);

// The same for libraries that insist on opening the file themselves: `write` receives the temporary path.
void write_path_atomically(const std::filesystem::path& target,
                           const std::function<void(const std::filesystem::path& temporary)>& write);

// Creates a result folder with its parents. Throws InputError when that fails or the folder cannot be
// written.
void create_output_folder(const std::filesystem::path& folder);

}  // namespace trueblade
