// The errors of the program that a user can cause or meet. What is not one of these is a defect of ours.
#pragma once

#include <stdexcept>
#include <string>

namespace trueblade {

// Bad input: a file, an option or a value that breaks a stated constraint. The command ends with exit code 2.
// The message names, where they exist, the file, the line, the value and the constraint, as in
// "blade.yaml:12: chord_tolerance_mm is -0.01, must be above 0".
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

// "file: message", for a defect of a whole file.
InputError file_error(const std::string& file, const std::string& message);
// "file:line: message", for a defect at a line (counted from 1).
InputError line_error(const std::string& file, int line, const std::string& message);

}  // namespace trueblade
