#include "geometry/error.h"

namespace trueblade {

InputError file_error(const std::string& file, const std::string& message) {
  return InputError(file + ": " + message);
}

InputError line_error(const std::string& file, int line, const std::string& message) {
  return InputError(file + ":" + std::to_string(line) + ": " + message);
}

}  // namespace trueblade
