// Parts, scans and folders shared by the tests of this folder.
#pragma once

#include <filesystem>
#include <string>

#include "inspection/deviations.h"
#include "inspection/result.h"
#include "part/part.h"

namespace trueblade {

// An icosahedron divided `times` times, its nodes on the sphere about the origin; surface 0 above z = 0,
// surface 1 below.
Part sphere_part(double radius_mm, int times);

// A plate |x|, |y| <= 10, |z| <= half the thickness, closed; surface 0 on top, 1 below, 2 around.
Part plate_part(double thickness_mm);

// For every facet of the part one measured point, `offset_mm` above its centroid along its normal.
ScanPoints scan_above_facets(const Part& part, double offset_mm);

// evaluate_deviations with freshly built search structures.
Deviations deviations_of(const Part& part, const ScanPoints& scan, const RigidTransform& part_from_mcs);

// A folder of its own under the system's temporary folder, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

std::string bytes_of(const std::filesystem::path& file);

}  // namespace trueblade
