// The effect of each error source in closed form, on a plane. Used by a test, and by the benchmark that
// prints the table of all sources.
//
// A beam that ends at a point of the plane is displaced there, relative to the part, by (source value) * d.
// The machine reports the point that its nominal geometry gives; to first order its distance from the nominal
// plane is -(normal . d) * value. d is a unit vector for a shift, axis x lever arm for an angle, velocity for
// a time.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "sim/simulated_machine.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade::testing {

struct ErrorScene {
  VirtualSetup setup;
  Vec3 plane_normal;  // PCS
  VirtualPart part;
  double theta_rad;
};

inline Vec3 beam_in_part(const ErrorScene& scene) {
  return scene.setup.part_from_mcs.rotation *
         beam_in_mcs(scene.setup.geometry, {0.0, 0.0, 0.0, scene.theta_rad}).direction;
}

// A machine in which no source is without effect: axes carried z, x, y; mount and rotary axis off the origin.
inline ErrorScene error_scene() {
  ErrorScene scene;
  scene.theta_rad = 0.8;
  VirtualSetup& setup = scene.setup;
  setup.geometry.linear_axis_order = {LinearAxis::z, LinearAxis::x, LinearAxis::y};
  setup.geometry.stage_from_probe_at_zero.translation_mm = {7.0, 130.0, -11.0};
  setup.geometry.stage_from_probe_at_zero.rotation = rotation_from_vector({0.2, 0.1, -0.15});
  setup.geometry.rotary_axis_point_mm = {4.0, -9.0, 0.0};
  setup.geometry.rotary_axis_direction = Vec3(0.02, 0.05, 1.0).normalized();
  setup.lens = standard_lens("100mm");
  setup.sensor = perfect_sensor();
  setup.part_from_mcs.rotation = rotation_from_vector({0.3, -0.2, 0.6});
  setup.part_from_mcs.translation_mm = {3.0, -5.0, 8.0};
  setup.mcs_from_fixture.rotation = rotation_from_vector({-0.4, 0.1, 0.2});
  setup.mcs_from_fixture.translation_mm = {20.0, -15.0, -60.0};
  setup.dynamics.max_speed = {20.0, 20.0, 20.0, 0.5};

  // A large plane through the origin of the PCS, tilted against the beam by 36 degrees.
  const Vec3 beam = beam_in_part(scene), across = beam.unitOrthogonal();
  scene.plane_normal = (-beam + 0.6 * across + 0.4 * beam.cross(across)).normalized();
  const Vec3 u = scene.plane_normal.unitOrthogonal(), v = scene.plane_normal.cross(u);
  FacetSoup soup;
  soup.nodes_mm = {-500.0 * u - 500.0 * v, 500.0 * u - 500.0 * v, 500.0 * u + 500.0 * v,
                   -500.0 * u + 500.0 * v};
  soup.facets = {{0, 1, 2}, {0, 2, 3}};
  auto part = std::make_shared<const Part>(part_of(soup));
  auto caster = std::make_shared<const RayCaster>(part->model);
  scene.part = make_virtual_part(part, caster);
  return scene;
}

// One line of `count` samples on a skew way over 60 mm by 25 mm of the plane, 8 mm to and fro along the beam,
// so that the probe also moves across the plane.
inline std::vector<AxisPositions> error_scene_path(const ErrorScene& scene, std::size_t count) {
  const VirtualSetup& setup = scene.setup;
  const RigidTransform mcs_from_part = setup.part_from_mcs.inverse();
  const Vec3 u = scene.plane_normal.unitOrthogonal(), v = scene.plane_normal.cross(u);
  std::vector<AxisPositions> path;
  for (std::size_t k = 0; k < count; ++k) {
    // A triangle wave of 30 mm amplitude.
    const double s = 2.0 * std::asin(std::sin(0.05 * static_cast<double>(k))) / std::numbers::pi;
    const Vec3 point = 30.0 * s * u + (25.0 * static_cast<double>(k) / static_cast<double>(count)) * v;
    const double range_mm = setup.lens.standoff_mm + 8.0 * std::sin(0.11 * static_cast<double>(k));
    path.push_back(axes_for_probe_origin(
        setup.geometry, mcs_from_part * (point - range_mm * beam_in_part(scene)), scene.theta_rad));
  }
  return path;
}

// -(normal . d) in the text above: deviation of the reported point per unit of the source.
inline double effect_of(const ErrorScene& scene, ErrorSource source, const ProbeSample& sample,
                        const Vec3& velocity_stage_mm_per_s) {
  using enum ErrorSource;
  // Everything in `stage`.
  const MachineGeometry& g = scene.setup.geometry;
  const RigidTransform table = stage_from_mcs(g, sample.axes.theta_rad);
  const Vec3 n = (table * scene.setup.part_from_mcs.inverse()).rotation * scene.plane_normal;
  const RigidTransform probe = stage_from_probe(g, sample.axes);
  const Vec3 beam = probe.rotation * g.beam_direction;
  const Vec3 hit = probe.translation_mm + sample.distance_mm * beam;
  const auto& axis = g.axis_direction;

  const auto beam_moves = [&](const Vec3& d) { return -n.dot(d); };
  const auto part_moves = [&](const Vec3& d) { return n.dot(d); };
  const auto turn = [&](const Vec3& about, const Vec3& centre) -> Vec3 { return about.cross(hit - centre); };

  const auto number_from = [&](ErrorSource first) {
    return static_cast<int>(source) - static_cast<int>(first);
  };
  if (source <= fixture_c) {
    const RigidTransform fixture = table * scene.setup.mcs_from_fixture;
    const int component = number_from(part_x) % 6;
    const Vec3 direction = fixture.rotation * Vec3(Vec3::Unit(component % 3));
    return part_moves(component < 3 ? direction : turn(direction, fixture.translation_mm));
  }
  if (source <= probe_z) return beam_moves(probe.rotation * Vec3(Vec3::Unit(number_from(probe_x))));
  if (source <= beam_b) {
    const Vec3 first = g.beam_direction.unitOrthogonal();
    const Vec3 about = source == beam_a ? first : Vec3(g.beam_direction.cross(first));
    return beam_moves(turn(probe.rotation * about, probe.translation_mm));
  }
  if (source <= ecz) {
    const int moving = number_from(exx) / 6;
    const int component = number_from(exx) % 6;
    const Vec3 direction = axis[static_cast<std::size_t>(component % 3)];
    // The carriage of the moving axis: z carries x, x carries y.
    Vec3 carriage = sample.axes.z_mm * axis[2];
    if (moving != 2) carriage += sample.axes.x_mm * axis[0];
    if (moving == 1) carriage += sample.axes.y_mm * axis[1];
    return beam_moves(component < 3 ? direction : turn(direction, carriage));
  }
  if (source == c0y) return beam_moves(sample.axes.y_mm * axis[2].cross(axis[1]));
  if (source == b0z) return beam_moves(sample.axes.z_mm * axis[1].cross(axis[2]));
  if (source == a0z) return beam_moves(sample.axes.z_mm * axis[0].cross(axis[2]));
  if (source <= boc) {
    const Vec3 z = g.rotary_axis_direction;
    const Vec3 x = (axis[0] - axis[0].dot(z) * z).normalized();
    const Vec3 y = z.cross(x);
    const Vec3& p = g.rotary_axis_point_mm;
    const Mat3 rotation = table.rotation.toRotationMatrix();
    const Vec3 before = rotation.transpose() * (hit - p);  // from the axis, with the table at angle 0
    switch (source) {
      case exc:
        return part_moves(x);
      case eyc:
        return part_moves(y);
      case ezc:
        return part_moves(z);
      case eac:
        return part_moves(turn(x, p));
      case ebc:
        return part_moves(turn(y, p));
      case ecc:
        return part_moves(turn(z, p));
      case xoc:
        return part_moves(x - rotation * x);
      case yoc:
        return part_moves(y - rotation * y);
      case aoc:
        return part_moves(x.cross(rotation * before) - rotation * x.cross(before));
      default:
        return part_moves(y.cross(rotation * before) - rotation * y.cross(before));
    }
  }
  if (source == sensor_distance) return n.dot(beam);  // the reported point itself moves along the beam
  if (source == time_base) return beam_moves(velocity_stage_mm_per_s);
  return beam_moves(sample.time_s * Vec3(Vec3::Unit(number_from(drift_x))));
}

// The values of the source, drawn for each point, as its effect on the reported points tells them: distance
// of the reported point from the nominal plane over effect_of. `count` of them.
inline std::vector<double> observed_values(ErrorScene scene, ErrorSource source, double mean, double sigma,
                                           std::size_t count) {
  scene.setup.errors[source] = {mean, sigma, ErrorScope::point};
  SimulatedMachine machine(scene.part, scene.setup);
  machine.connect();
  machine.home();
  // Some positions show nothing of the source (a lever arm or a speed passes zero there): half as many again
  // do for every source.
  const auto path = error_scene_path(scene, count + count / 2);
  machine.move_to(path.front());
  std::vector<ProbeSample> samples;
  machine.scan_line(path, [&](const ProbeSample& sample) {
    samples.push_back(sample);
    return true;
  });
  const MachineGeometry& geometry = scene.setup.geometry;
  const auto motion = line_motion(scene.setup.dynamics, scene.setup.lens, path.front(), path);
  std::vector<double> values;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const AxisPositions& axis_velocity = motion[k].velocity_per_s;
    const Vec3 velocity = geometry.axis_direction[0] * axis_velocity.x_mm +
                          geometry.axis_direction[1] * axis_velocity.y_mm +
                          geometry.axis_direction[2] * axis_velocity.z_mm;
    const Vec3 reported = scene.setup.part_from_mcs * point_in_mcs_mm(geometry, samples[k]);
    const double effect = effect_of(scene, source, samples[k], velocity);
    // Where an effect changes its sign the source cannot be observed.
    if (std::abs(effect) > 0.1 && values.size() < count)
      values.push_back(scene.plane_normal.dot(reported) / effect);
  }
  if (values.size() < count) throw std::logic_error("too few positions show the source");
  return values;
}

// A spread that is small enough for first order: 1 um, 10 urad, 0.1 ms, 0.1 um/s.
inline double usual_sigma(ErrorSource source) {
  const std::string_view unit = info(source).unit;
  if (unit == "mm") return 1e-3;
  if (unit == "rad") return 1e-5;
  return 1e-4;
}

}  // namespace trueblade::testing
