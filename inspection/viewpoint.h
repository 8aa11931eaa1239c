// Where a picture is taken from: an orthographic camera, so that lengths in the picture are lengths on the
// part.
#pragma once

#include <string>
#include <vector>

#include "geometry/ray_caster.h"
#include "geometry/rigid_transform.h"
#include "hardware/machine_geometry.h"

namespace trueblade {

// Directions in the part frame, unit.
struct Viewpoint {
  std::string name;
  Vec3 to_camera = Vec3::UnitY();
  Vec3 up = Vec3::UnitZ();  // drawn upward, as far as it is not along to_camera
};

// As the probe sees the part: against the beam; up is the direction of the rotary axis. `beam_mcs` and
// `rotary_axis_mcs` are those of the view in the MCS.
Viewpoint viewpoint_as_probe(const std::string& name, const Vec3& beam_mcs, const Vec3& rotary_axis_mcs,
                             const RigidTransform& part_from_mcs);

// The same for a view of the machine at the rotary angle.
Viewpoint viewpoint_of_view(const std::string& name, const MachineGeometry& geometry, double theta_rad,
                            const RigidTransform& part_from_mcs);

// From obliquely above, turned by 35 degrees about the up direction from `base` and raised by 25 degrees.
Viewpoint oblique_viewpoint(const std::string& name, const Viewpoint& base);

// Along the axes of the part frame, from either side (z up; y up where the camera looks along z), and
// obliquely from between -x, +y and +z. Named from_plus_x ... from_minus_z, oblique.
std::vector<Viewpoint> fixed_viewpoints();

struct Camera {
  Vec3 centre_mm;             // of the picture, on a plane in front of everything in the box
  Vec3 right, up, to_camera;  // orthonormal, right-handed
  double mm_per_pixel;
  int width_px, height_px;

  // Pixel coordinates grow right and down; (0.5, 0.5) is the middle of the first pixel.
  Ray ray(double x_px, double y_px) const;
  Vec2 pixel(const Vec3& point_mm) const;
  double depth_mm(const Vec3& point_mm) const;  // from the plane of the camera, away from it
};

// The camera of the given picture size that shows the whole box with a margin of 4 percent.
Camera camera_for_box(const Viewpoint& viewpoint, const Vec3& lower_mm, const Vec3& upper_mm, int width_px,
                      int height_px);

}  // namespace trueblade
