#include "inspection/result.h"

namespace trueblade {

PoseError pose_error(const RigidTransform& part_from_mcs, const RigidTransform& true_part_from_mcs,
                     const Vec3& centroid_mcs_mm) {
  return {true_part_from_mcs, (part_from_mcs * centroid_mcs_mm - true_part_from_mcs * centroid_mcs_mm).norm(),
          rotation_angle_between(part_from_mcs, true_part_from_mcs)};
}

}  // namespace trueblade
