// The machine block of a scenario: which backend measures, its lens and geometry, where the part stands by
// the set-up, and, for the simulated backend, how far the truth may be from all that.
#pragma once

#include <filesystem>
#include <string>

#include "apps/yaml_fields.h"
#include "hardware/axis_dynamics.h"
#include "hardware/lens.h"
#include "hardware/linuxcnc/linuxcnc_machine.h"
#include "hardware/machine_geometry.h"
#include "sim/form_errors.h"
#include "sim/machine_errors.h"
#include "sim/sensor_model.h"
#include "sim/virtual_part.h"

namespace trueblade {

struct SimulationSpec {
  RigidTransform mcs_from_fixture;  // the frame in which the fixture's errors act
  MachineErrors errors;
  SensorModel sensor;
  std::optional<PartSurfaceMode>
      surface;             // what the beam meets; default: exact where the part has CAD surfaces
  FormErrors form_errors;  // of the part that stands on the machine
};

struct MachineSpec {
  std::string backend = "simulated";
  Lens lens = standard_lens("25mm");
  MachineGeometry geometry;
  AxisLimits limits{{-500.0, -500.0, -500.0, -100.0}, {500.0, 500.0, 500.0, 100.0}};
  AxisDynamics dynamics;
  RigidTransform mcs_from_part;  // the preliminary transformation of the set-up (P12), as the part stands
  SimulationSpec simulation;
  LinuxCncSettings linuxcnc;
  std::filesystem::path journal;  // what the backend "recorded" replays
};

// Paths in the file are relative to `folder`.
void fields(YamlFields& io, MachineSpec& machine, const std::filesystem::path& folder);

}  // namespace trueblade
