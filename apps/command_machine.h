// The command `trueblade machine`: bring-up of a real machine.
#pragma once

#include "apps/command.h"

namespace trueblade {

void add_machine_command(CLI::App& app, CommandLine& line);

}  // namespace trueblade
