#include "apps/command.h"

int main(int argc, char** argv) {
  return trueblade::run_command_line({argv + 1, argv + argc});
}
