// Bring-up of a machine that is connected and homed: its geometry from scans of a reference sphere, and where
// the part stands from a few points touched with the beam. docs/linuxcnc.md has the steps.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/command.h"

namespace trueblade {

// Adds `calibrate`, `touch` and `locate` to the command `machine`.
void add_calibration_commands(CLI::App& machine, CommandLine& line);

}  // namespace trueblade
