// Runs the built `trueblade` as a user does: a process of its own, with a time limit, so that a crash or a
// hang fails one test and no more.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace trueblade {

struct ChildResult {
  int exit_code = -1;    // -1: ended by a signal or by the time limit
  std::string ended_by;  // "exit", "signal <n>", "time limit"
  std::string out;
  std::string err;
};

struct ChildOptions {
  double time_limit_s = 120.0;
  std::string interrupt_after = {};  // when these words appear on standard error, Ctrl-C is sent once
  std::function<bool()> interrupt_when = {};  // as soon as it holds, Ctrl-C is sent once
  std::function<bool()> kill_when = {};       // as soon as it holds, the program is killed (SIGKILL)
  std::size_t largest_file_bytes = 0;         // a disk that is full beyond it; 0: no limit
};

// `working_folder` is where the command runs.
ChildResult run_trueblade(
    const std::vector<std::string>& arguments,
    const std::filesystem::path& working_folder = std::filesystem::temp_directory_path(),
    const ChildOptions& options = {});

// A new empty folder, removed with everything in it at the end of the scope.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  // Writes a small file there and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

std::string text_of(const std::filesystem::path& file);

}  // namespace trueblade
