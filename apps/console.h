// What the user sees while the program works: everything here goes to standard error. Standard output
// belongs to results.
#pragma once

#include <cstddef>
#include <string>

namespace trueblade {

// Routes the log to standard error, plain lines without time stamps.
void start_log();

// Progress of long work: a bar that is redrawn on a terminal, a plain line at every tenth elsewhere.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();  // ends the bar's line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void report(std::size_t done, std::size_t total);

 private:
  std::string label_;
  bool terminal_;
  bool drawn_ = false;
  std::size_t last_step_ = 0;
};

}  // namespace trueblade
