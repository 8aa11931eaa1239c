// Where a scan lies: the pose of the machine set-up, and in simulation the true one. `trueblade scan` writes
// it beside the points, `trueblade register --initial` reads it.
#pragma once

#include <filesystem>
#include <optional>

#include "geometry/rigid_transform.h"

namespace trueblade {

struct ScanPose {
  RigidTransform part_from_mcs;                      // by the set-up: the initial pose of the registration
  std::optional<RigidTransform> true_part_from_mcs;  // known in simulation
};

// YAML or JSON: part_from_mcs: {rotation_wxyz: [w, x, y, z], translation_mm: [x, y, z]}, and optionally
// true_part_from_mcs in the same form. Throws InputError naming file and line.
ScanPose read_scan_pose(const std::filesystem::path& file);

// Writes what reads back to the same bits.
void write_scan_pose(const std::filesystem::path& file, const ScanPose& pose);

}  // namespace trueblade
