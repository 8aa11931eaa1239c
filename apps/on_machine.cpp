#include "apps/on_machine.h"

#include <fmt/format.h>

#include "apps/interrupt.h"

namespace trueblade {

void on_machine(const MachineSpec& spec, const std::function<void(LinuxCncMachine&)>& work) {
  LinuxCncMachine machine(spec.linuxcnc, spec.limits, spec.dynamics);
  machine.stop_when(interrupted);
  machine.connect();
  try {
    work(machine);
  } catch (const MachineFault& fault) {
    throw MachineFault(fault.kind(),
                       fmt::format("{}; the machine is {}", fault.what(), to_string(machine.state())));
  }
}

}  // namespace trueblade
