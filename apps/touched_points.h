// The file of touched points: what `trueblade machine touch` adds to, reading by reading, and `locate` reads.
//
//   sigma_mm: 0.5                       # how well the beam is brought onto a point
//   points:
//     - {name: tip, part_mm: [0, 0, 90], x_mm: 1.5, y_mm: ..., z_mm: ..., theta_deg: 0, distance_mm: 25.1}
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/locate_part.h"
#include "hardware/machine_geometry.h"

namespace trueblade {

// The reading and not the point it gives is kept, so that a later calibration of the machine counts for it.
struct TouchReading {
  std::string name;
  Vec3 part_mm = Vec3::Zero();
  ProbeSample sample;
};

struct TouchFile {
  double sigma_mm = 0.5;
  std::vector<TouchReading> points;
};

// Throws InputError naming file and line.
TouchFile read_touch_file(const std::filesystem::path& file);
void write_touch_file(const std::filesystem::path& file, const TouchFile& touched);

std::vector<TouchedPoint> touched_points(const TouchFile& touched, const MachineGeometry& geometry);

}  // namespace trueblade
