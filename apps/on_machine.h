// Work on a real machine outside a scan.
#pragma once

#include <functional>

#include "apps/machine_fields.h"

namespace trueblade {

// Connects to the machine and does the work; Ctrl-C ends whatever moves. The words of a fault say how it
// leaves the machine. Precondition: the backend is linuxcnc.
void on_machine(const MachineSpec& spec, const std::function<void(LinuxCncMachine&)>& work);

}  // namespace trueblade
