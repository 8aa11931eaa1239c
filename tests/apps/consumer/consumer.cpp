// Registers points on the faces of a unit cube, moved by a known shift, to the cube.
#include <cstdio>

#include "part/part.h"
#include "registration/register_scan.h"
#include "registration/target.h"

int main(int, char** argv) {
  using namespace trueblade;
  PartOptions options;
  options.unit = LengthUnit::millimetre;
  const Part part = read_part(argv[1], options);
  ScanPoints scan;
  for (double u = 0.125; u < 1.0; u += 0.25)
    for (double v = 0.125; v < 1.0; v += 0.25)
      for (const double side : {0.0, 1.0})
        for (const Vec3& p : {Vec3(side, u, v), Vec3(u, side, v), Vec3(u, v, side)})
          scan.position_mcs_mm.push_back(p + Vec3(0.01, -0.02, 0.03));
  const RegistrationResult result =
      register_scan(RegistrationTarget(part), scan, RigidTransform(), preset("default"));
  const Vec3 error_mm = result.part_from_mcs.translation_mm - Vec3(-0.01, 0.02, -0.03);
  std::printf("translation error %.3g mm, %s\n", error_mm.norm(), to_string(result.termination).c_str());
  // 32 points on each of three pairs of opposite faces determine the pose; noise-free data come back to
  // rounding, 1e-16 mm times the condition of the problem, which 1e-9 mm covers by far.
  return error_mm.norm() < 1e-9 ? 0 : 1;
}
