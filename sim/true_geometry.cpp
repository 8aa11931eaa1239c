#include "sim/true_geometry.h"

#include <algorithm>

namespace trueblade {
namespace {

using enum ErrorSource;

struct AxisErrorSources {
  ErrorSource x, y, z, a, b, c;
};

constexpr std::array<AxisErrorSources, 3> kLinearAxisErrors{
    {{exx, eyx, ezx, eax, ebx, ecx}, {exy, eyy, ezy, eay, eby, ecy}, {exz, eyz, ezz, eaz, ebz, ecz}}};

Vec3 values_of(const ErrorValues& errors, ErrorSource x, ErrorSource y, ErrorSource z) {
  return {errors[x], errors[y], errors[z]};
}

// A small motion given along and about the columns of `directions`.
RigidTransform small_motion(const Mat3& directions, const Vec3& shift_mm, const Vec3& rotation_rad) {
  RigidTransform motion;
  motion.rotation = rotation_from_vector(directions * rotation_rad);
  motion.translation_mm = directions * shift_mm;
  return motion;
}

RigidTransform shift(const Vec3& by_mm) {
  RigidTransform motion;
  motion.translation_mm = by_mm;
  return motion;
}

// The directions in which the linear axes truly run: y turned by C0Y against x, z by B0Z and A0Z.
Mat3 true_axis_directions(const Mat3& directions, const ErrorValues& errors) {
  Mat3 turned = directions;
  turned.col(1) = rotation_from_vector(directions.col(2) * errors[c0y]) * directions.col(1);
  turned.col(2) = rotation_from_vector(directions.col(0) * errors[a0z] + directions.col(1) * errors[b0z]) *
                  directions.col(2);
  return turned;
}

// Place and direction of the rotary axis: it turns about the nominal direction through this frame's origin.
RigidTransform true_stage_from_axis(const MachineGeometry& nominal, const ErrorValues& errors) {
  return shift(nominal.rotary_axis_point_mm) * small_motion(rotary_axis_normals(nominal),
                                                            {errors[xoc], errors[yoc], 0.0},
                                                            {errors[aoc], errors[boc], 0.0});
}

}  // namespace

TrueProbeChain true_probe_chain(const MachineGeometry& nominal, const ErrorValues& errors) {
  const Mat3 directions = axis_directions(nominal);
  const Mat3 true_directions = true_axis_directions(directions, errors);

  TrueProbeChain chain{Eigen::Quaterniond::Identity(), Vec3::Zero(), {}, {}, {}, {}};
  for (const LinearAxis axis : nominal.linear_axis_order) {
    const auto k = static_cast<std::size_t>(axis);
    const AxisErrorSources& e = kLinearAxisErrors[k];
    chain.origin_per_travel.col(static_cast<Eigen::Index>(k)) =
        chain.rotation * true_directions.col(static_cast<Eigen::Index>(k));
    chain.origin_per_axis_shift[k] = chain.rotation * directions;
    chain.origin_at_zero_mm += chain.origin_per_axis_shift[k] * values_of(errors, e.x, e.y, e.z);
    chain.rotation = chain.rotation * rotation_from_vector(directions * values_of(errors, e.a, e.b, e.c));
  }
  chain.origin_at_zero_mm += chain.rotation * nominal.stage_from_probe_at_zero.translation_mm;
  chain.rotation = (chain.rotation * nominal.stage_from_probe_at_zero.rotation).normalized();
  chain.origin_per_probe_shift = chain.rotation.toRotationMatrix();
  chain.origin_at_zero_mm += chain.origin_per_probe_shift * values_of(errors, probe_x, probe_y, probe_z);
  chain.origin_per_s_mm = values_of(errors, drift_x, drift_y, drift_z);
  return chain;
}

bool is_shift_of_probe(ErrorSource source) {
  const auto is_of = [&](const AxisErrorSources& e) {
    return source == e.x || source == e.y || source == e.z;
  };
  return (source >= probe_x && source <= probe_z) || std::ranges::any_of(kLinearAxisErrors, is_of);
}

Vec3 origin_per_value(const TrueProbeChain& chain, ErrorSource source) {
  if (source >= probe_x && source <= probe_z)
    return chain.origin_per_probe_shift.col(static_cast<int>(source) - static_cast<int>(probe_x));
  for (std::size_t k = 0; k < kLinearAxisErrors.size(); ++k) {
    const AxisErrorSources& e = kLinearAxisErrors[k];
    if (source == e.x) return chain.origin_per_axis_shift[k].col(0);
    if (source == e.y) return chain.origin_per_axis_shift[k].col(1);
    if (source == e.z) return chain.origin_per_axis_shift[k].col(2);
  }
  return Vec3::Zero();
}

RigidTransform true_stage_from_probe(const MachineGeometry& nominal, const AxisPositions& axes,
                                     const ErrorValues& errors, double drift_time_s) {
  const TrueProbeChain chain = true_probe_chain(nominal, errors);
  RigidTransform stage_from_probe;
  stage_from_probe.rotation = chain.rotation;
  stage_from_probe.translation_mm = chain.origin_at_zero_mm +
                                    chain.origin_per_travel * Vec3(axes.x_mm, axes.y_mm, axes.z_mm) +
                                    drift_time_s * chain.origin_per_s_mm;
  return stage_from_probe;
}

RigidTransform true_stage_from_mcs(const MachineGeometry& nominal, double theta_rad,
                                   const ErrorValues& errors) {
  const Mat3 directions = rotary_axis_normals(nominal);
  const RigidTransform stage_from_axis = true_stage_from_axis(nominal, errors);
  const RigidTransform error_motion =
      small_motion(directions, values_of(errors, exc, eyc, ezc), {errors[eac], errors[ebc], 0.0});
  RigidTransform turn;
  turn.rotation = Eigen::AngleAxisd(theta_rad + errors[ecc], nominal.rotary_axis_direction);
  return stage_from_axis * error_motion * turn * stage_from_axis.inverse();
}

RigidTransform true_mcs_from_part(const RigidTransform& nominal_mcs_from_part,
                                  const RigidTransform& mcs_from_fixture, const ErrorValues& errors) {
  const Mat3 own_axes = Mat3::Identity();
  const RigidTransform fixture_on_table =
      small_motion(own_axes, values_of(errors, fixture_x, fixture_y, fixture_z),
                   values_of(errors, fixture_a, fixture_b, fixture_c));
  const RigidTransform part_in_fixture = small_motion(own_axes, values_of(errors, part_x, part_y, part_z),
                                                      values_of(errors, part_a, part_b, part_c));
  return mcs_from_fixture * fixture_on_table * part_in_fixture * mcs_from_fixture.inverse() *
         nominal_mcs_from_part;
}

MachineGeometry true_geometry(const MachineGeometry& nominal, const ErrorValues& errors) {
  MachineGeometry geometry = nominal;
  geometry.stage_from_probe_at_zero = true_stage_from_probe(nominal, {}, errors, 0.0);
  geometry.beam_direction = true_beam_direction(nominal, errors);
  const RigidTransform stage_from_axis = true_stage_from_axis(nominal, errors);
  geometry.rotary_axis_point_mm = stage_from_axis.translation_mm;
  geometry.rotary_axis_direction = stage_from_axis.rotation * nominal.rotary_axis_direction;
  return geometry;
}

Vec3 true_beam_direction(const MachineGeometry& nominal, const ErrorValues& errors) {
  return rotation_from_vector(beam_normals(nominal) * Vec2(errors[beam_a], errors[beam_b])) *
         nominal.beam_direction;
}

}  // namespace trueblade
