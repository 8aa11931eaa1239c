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
#include "hardware/probe_body.h"
#include "sim/form_errors.h"
#include "sim/machine_errors.h"
#include "sim/sensor_model.h"
#include "sim/virtual_part.h"

namespace trueblade {

struct SimulationSpec {
  MachineErrors errors;
  SensorModel sensor;
  // What the beam meets; default: exact where the part has CAD surfaces.
  std::optional<PartSurfaceMode> part_surface;
  FormErrors form_errors;  // of the part that stands on the machine
  // Of the draws of the sensor and of random form errors, as GaussianError has it.
  std::uint32_t sensor_replicate = 0;
  std::uint32_t form_replicate = 0;
};

// The probe stands clear of the part with all axes at zero: home.
inline MachineGeometry default_geometry() {
  MachineGeometry geometry;
  geometry.stage_from_probe_at_zero.translation_mm = {0.0, 120.0, 60.0};
  return geometry;
}

struct MachineSpec {
  std::string backend = "simulated";
  Lens lens = standard_lens("25mm");
  MachineGeometry geometry = default_geometry();
  ProbeBody probe;
  AxisLimits limits{{-500.0, -500.0, -500.0, -100.0}, {500.0, 500.0, 500.0, 100.0}};
  AxisDynamics dynamics;
  RigidTransform mcs_from_fixture;  // the fixture on the table: the frame in which its errors act
  RigidTransform mcs_from_part;     // the preliminary transformation of the set-up (P12), as the part stands
  SimulationSpec simulation;
  LinuxCncSettings linuxcnc;
  std::filesystem::path journal;  // what the backend "recorded" replays
};

// The keys of a machine's geometry block.
void fields(YamlFields& io, MachineGeometry& geometry);

// `file: machine.yaml` takes the machine from a file of its own; the other keys override what stands there.
// Paths are relative to `folder`, that of the YAML file.
void fields(YamlFields& io, MachineSpec& machine, const std::filesystem::path& folder);

// A machine in a file of its own. Throws InputError.
MachineSpec read_machine(const std::filesystem::path& file);

}  // namespace trueblade
