#include "inspection/viewpoint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

namespace trueblade {
namespace {

Vec3 corner_of_box(const Vec3& lower, const Vec3& upper, int corner) {
  return {corner & 1 ? upper.x() : lower.x(), corner & 2 ? upper.y() : lower.y(),
          corner & 4 ? upper.z() : lower.z()};
}

// `up` without its part along `to_camera`; another axis when nothing is left.
Vec3 upright(const Vec3& up, const Vec3& to_camera) {
  const Vec3 across = up - up.dot(to_camera) * to_camera;
  return across.norm() > 1e-6 ? Vec3(across.normalized()) : to_camera.unitOrthogonal();
}

}  // namespace

Viewpoint viewpoint_as_probe(const std::string& name, const Vec3& beam_mcs, const Vec3& rotary_axis_mcs,
                             const RigidTransform& part_from_mcs) {
  return {name, part_from_mcs.rotation * -beam_mcs, part_from_mcs.rotation * rotary_axis_mcs};
}

Viewpoint viewpoint_of_view(const std::string& name, const MachineGeometry& geometry, double theta_rad,
                            const RigidTransform& part_from_mcs) {
  return viewpoint_as_probe(name, beam_in_mcs(geometry, {.theta_rad = theta_rad}).direction,
                            geometry.rotary_axis_direction, part_from_mcs);
}

Viewpoint oblique_viewpoint(const std::string& name, const Viewpoint& base) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const Vec3 up = upright(base.up, base.to_camera);
  const Vec3 turned = Eigen::AngleAxisd(35.0 * kDegree, up) * base.to_camera;
  const Vec3 raised = Eigen::AngleAxisd(25.0 * kDegree, turned.cross(up)) * turned;
  return {name, raised, up};
}

std::vector<Viewpoint> fixed_viewpoints() {
  std::vector<Viewpoint> viewpoints;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool plus : {true, false}) {
      const Vec3 to_camera = (plus ? 1.0 : -1.0) * Vec3::Unit(axis);
      viewpoints.push_back({std::string("from_") + (plus ? "plus_" : "minus_") + "xyz"[axis], to_camera,
                            axis == 2 ? Vec3::UnitY() : Vec3::UnitZ()});
    }
  viewpoints.push_back(oblique_viewpoint("oblique", Viewpoint{}));
  return viewpoints;
}

Ray Camera::ray(double x_px, double y_px) const {
  const double x_mm = (x_px - 0.5 * width_px) * mm_per_pixel;
  const double y_mm = (0.5 * height_px - y_px) * mm_per_pixel;
  return {centre_mm + x_mm * right + y_mm * up, -to_camera};
}

Vec2 Camera::pixel(const Vec3& point_mm) const {
  const Vec3 d = point_mm - centre_mm;
  return {0.5 * width_px + d.dot(right) / mm_per_pixel, 0.5 * height_px - d.dot(up) / mm_per_pixel};
}

double Camera::depth_mm(const Vec3& point_mm) const {
  return (centre_mm - point_mm).dot(to_camera);
}

Camera camera_for_box(const Viewpoint& viewpoint, const Vec3& lower_mm, const Vec3& upper_mm, int width_px,
                      int height_px) {
  Camera camera;
  camera.to_camera = viewpoint.to_camera.normalized();
  camera.up = upright(viewpoint.up, camera.to_camera);
  camera.right = camera.up.cross(camera.to_camera);
  camera.width_px = width_px;
  camera.height_px = height_px;

  const Vec3 middle = 0.5 * (lower_mm + upper_mm);
  double half_width = 0.0, half_height = 0.0, half_depth = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 d = corner_of_box(lower_mm, upper_mm, corner) - middle;
    half_width = std::max(half_width, std::abs(d.dot(camera.right)));
    half_height = std::max(half_height, std::abs(d.dot(camera.up)));
    half_depth = std::max(half_depth, std::abs(d.dot(camera.to_camera)));
  }
  constexpr double kFilled = 0.92;  // 4 percent margin on each side
  camera.mm_per_pixel =
      std::max({2.0 * half_width / width_px, 2.0 * half_height / height_px, 1e-9}) / kFilled;
  camera.centre_mm = middle + 1.05 * half_depth * camera.to_camera;
  return camera;
}

}  // namespace trueblade
