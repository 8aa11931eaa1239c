#include "tests/apps/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace trueblade {
namespace {

[[noreturn]] void become_trueblade(const std::vector<std::string>& arguments,
                                   const std::filesystem::path& working_folder,
                                   const std::filesystem::path& out, const std::filesystem::path& err,
                                   std::size_t largest_file_bytes) {
  const int out_file = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err_file = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(out_file, STDOUT_FILENO);
  dup2(err_file, STDERR_FILENO);
  if (chdir(working_folder.c_str()) != 0) _exit(126);
  if (largest_file_bytes > 0) {
    const rlimit limit{largest_file_bytes, largest_file_bytes};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(126);
  }
  std::vector<char*> words;
  std::string program = TRUEBLADE_PROGRAM;
  words.push_back(program.data());
  std::vector<std::string> copies = arguments;
  for (std::string& argument : copies) words.push_back(argument.data());
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  _exit(127);
}

}  // namespace

ChildResult run_trueblade(const std::vector<std::string>& arguments,
                          const std::filesystem::path& working_folder, const ChildOptions& options) {
  const ScratchFolder scratch;
  const std::filesystem::path out = scratch / "out", err = scratch / "err";
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become_trueblade(arguments, working_folder, out, err, options.largest_file_bytes);

  ChildResult result;
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(options.time_limit_s);
  bool to_interrupt = !options.interrupt_after.empty() || options.interrupt_when;
  const auto is_time_to_interrupt = [&] {
    return options.interrupt_when ? options.interrupt_when()
                                  : text_of(err).find(options.interrupt_after) != std::string::npos;
  };
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (to_interrupt && is_time_to_interrupt()) {
      kill(child, SIGINT);
      to_interrupt = false;
    }
    if (options.kill_when && options.kill_when()) kill(child, SIGKILL);
    if (std::chrono::steady_clock::now() > deadline) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      result.ended_by = "time limit";
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (result.ended_by.empty()) {
    if (WIFEXITED(status)) {
      result.exit_code = WEXITSTATUS(status);
      result.ended_by = "exit";
    } else {
      result.ended_by = "signal " + std::to_string(WTERMSIG(status));
    }
  }
  result.out = text_of(out);
  result.err = text_of(err);
  return result;
}

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "trueblade_test_XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a scratch folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path ScratchFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace trueblade
