// The true machine in operation against the whole chain of true_geometry.h: what is worked out once per line
// gives the same beams as working out everything for every point.
#include "sim/true_machine.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "sim/true_geometry.h"

namespace trueblade {
namespace {

// Rotations far larger than any machine's, so that the order in which they act shows.
MachineErrors large_errors(ErrorScope of_shifts, ErrorScope of_rotations) {
  MachineErrors errors;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    const std::string_view unit = info(source).unit;
    if (unit == "mm") errors[source] = {0.02, 0.5, of_shifts};
    if (unit == "rad") errors[source] = {0.01, 0.05, of_rotations};
    if (unit == "s") errors[source] = {0.001, 0.002, ErrorScope::point};
    if (unit == "mm/s") errors[source] = {1e-4, 1e-3, of_rotations};
  }
  return errors;
}

void expect_the_whole_chain(const MachineErrors& errors) {
  MachineGeometry nominal;
  nominal.linear_axis_order = {LinearAxis::z, LinearAxis::x, LinearAxis::y};
  nominal.stage_from_probe_at_zero.translation_mm = {7.0, 130.0, -11.0};
  nominal.rotary_axis_point_mm = {4.0, -9.0, 0.0};
  const RigidTransform mcs_from_part{rotation_from_vector({0.3, -0.2, 0.6}), {3.0, -5.0, 8.0}};
  const RigidTransform mcs_from_fixture{rotation_from_vector({-0.4, 0.1, 0.2}), {20.0, -15.0, -60.0}};
  TrueMachine machine(nominal, mcs_from_part, mcs_from_fixture, errors, 5, 2);
  const double theta = 0.7;
  machine.begin_view(1, theta);
  machine.begin_line(4, theta);

  std::vector<AxisState> at;
  for (int k = 0; k < 150; ++k)
    at.push_back({{0.5 * k - 30.0, 0.1 * k, 60.0 - k, theta}, {5.0, -3.0, 2.0, 0.0}, 100.0 + 0.001 * k});
  std::vector<TrueMachine::Beam> beams(at.size());
  machine.beams_at(at, 1000, beams);

  ErrorValues values;
  draw_errors(errors, ErrorScope::setup, 5, 2, 0, values);
  draw_errors(errors, ErrorScope::view, 5, 2, 1, values);
  draw_errors(errors, ErrorScope::line, 5, 2, 4, values);
  for (std::size_t k = 0; k < at.size(); ++k) {
    draw_errors(errors, ErrorScope::point, 5, 2, 1000 + k, values);
    AxisPositions late = at[k].axes;
    late.x_mm += values[ErrorSource::time_base] * 5.0;
    late.y_mm -= values[ErrorSource::time_base] * 3.0;
    late.z_mm += values[ErrorSource::time_base] * 2.0;
    const RigidTransform part_from_stage = (true_stage_from_mcs(nominal, theta, values) *
                                            true_mcs_from_part(mcs_from_part, mcs_from_fixture, values))
                                               .inverse();
    const RigidTransform stage_from_probe = true_stage_from_probe(nominal, late, values, at[k].time_s);
    const Vec3 origin_mm = part_from_stage * stage_from_probe.translation_mm;
    const Vec3 direction =
        part_from_stage.rotation * (stage_from_probe.rotation * true_beam_direction(nominal, values));
    // Some twenty roundings of coordinates of 200 mm: 20 * 2.8e-14 mm.
    EXPECT_LT((beams[k].in_part.origin_mm - origin_mm).norm(), 1e-12);
    EXPECT_LT((beams[k].in_part.direction - direction).norm(), 1e-14);
    EXPECT_EQ(beams[k].distance_error_mm, values[ErrorSource::sensor_distance]);
    const TrueMachine::Beam alone = machine.beam_at(at[k], 1000 + k);
    EXPECT_EQ(alone.in_part.origin_mm, beams[k].in_part.origin_mm);
    EXPECT_EQ(alone.in_part.direction, beams[k].in_part.direction);
  }
}

TEST(TrueMachine, WithShiftsDrawnForEveryPoint) {
  MachineErrors errors = large_errors(ErrorScope::point, ErrorScope::line);
  for (const ErrorSource of_table :
       {ErrorSource::part_x, ErrorSource::part_y, ErrorSource::part_z, ErrorSource::fixture_x,
        ErrorSource::fixture_y, ErrorSource::fixture_z, ErrorSource::exc, ErrorSource::eyc, ErrorSource::ezc,
        ErrorSource::xoc, ErrorSource::yoc})
    errors[of_table].scope = ErrorScope::setup;
  expect_the_whole_chain(errors);
}

TEST(TrueMachine, WithTheTableDrawnForEveryPoint) {
  expect_the_whole_chain(large_errors(ErrorScope::point, ErrorScope::setup));
}

TEST(TrueMachine, WithRotationsDrawnForEveryPoint) {
  expect_the_whole_chain(large_errors(ErrorScope::view, ErrorScope::point));
}

TEST(TrueMachine, WithEverythingDrawnForEveryPoint) {
  expect_the_whole_chain(large_errors(ErrorScope::point, ErrorScope::point));
}

}  // namespace
}  // namespace trueblade
