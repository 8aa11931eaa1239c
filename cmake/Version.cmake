# Run at every build (cmake -P): writes OUTPUT with the program version and the commit, and touches it only when they
# changed, so that nothing is compiled again without need. Outside git the commit is "unknown".
execute_process(COMMAND git describe --always --dirty --abbrev=10 WORKING_DIRECTORY ${SOURCE_DIR}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failure)
if(failure OR commit STREQUAL "")
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "apps/version.h"

namespace trueblade {
std::string program_version() { return "@VERSION@"; }
std::string program_commit() { return "@commit@"; }
}  // namespace trueblade
]])
