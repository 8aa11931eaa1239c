#include "sim/true_machine.h"

#include <Eigen/Geometry>

#include "sim/true_geometry.h"

namespace trueblade {
namespace {

bool is_active(const GaussianError& error) {
  return error.mean != 0.0 || error.sigma != 0.0;
}

bool is_of_table(ErrorSource source) {
  return (source >= ErrorSource::part_x && source <= ErrorSource::fixture_c) ||
         (source >= ErrorSource::exc && source <= ErrorSource::boc);
}

bool is_of_probe_chain(ErrorSource source) {
  return (source >= ErrorSource::probe_x && source <= ErrorSource::a0z) ||
         (source >= ErrorSource::drift_x && source <= ErrorSource::drift_z);
}

}  // namespace

TrueMachine::TrueMachine(const MachineGeometry& nominal, const RigidTransform& nominal_mcs_from_part,
                         const RigidTransform& mcs_from_fixture, const MachineErrors& errors,
                         std::uint64_t seed, std::uint64_t trial)
    : nominal_(nominal),
      nominal_mcs_from_part_(nominal_mcs_from_part),
      mcs_from_fixture_(mcs_from_fixture),
      errors_(errors),
      seed_(seed),
      trial_(trial),
      point_stream_(error_stream(ErrorScope::point, seed, trial)) {
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    if (errors_[source].scope != ErrorScope::point || !is_active(errors_[source])) continue;
    per_point_.push_back(source);
    table_varies_ = table_varies_ || is_of_table(source);
    probe_chain_varies_ = probe_chain_varies_ || is_of_probe_chain(source);
  }
  for (const ErrorScope scope : {ErrorScope::setup, ErrorScope::view, ErrorScope::line})
    draw_errors(errors_, scope, seed_, trial_, 0, values_);
  work_out(0.0);
}

void TrueMachine::begin_view(std::uint64_t index, double theta_rad) {
  draw_errors(errors_, ErrorScope::view, seed_, trial_, index, values_);
  work_out(theta_rad);
}

void TrueMachine::begin_line(std::uint64_t index, double theta_rad) {
  draw_errors(errors_, ErrorScope::line, seed_, trial_, index, values_);
  work_out(theta_rad);
}

void TrueMachine::work_out(double theta_rad) {
  if (!probe_chain_varies_) {
    // The chain is linear in travel and time: five evaluations tell all of it.
    const auto at = [&](double x_mm, double y_mm, double z_mm, double time_s) {
      return true_stage_from_probe(nominal_, {x_mm, y_mm, z_mm, 0.0}, values_, time_s);
    };
    const RigidTransform zero = at(0, 0, 0, 0);
    SteadyChain chain;
    chain.origin_at_zero_mm = zero.translation_mm;
    // From 1 m and 1 h, so that the difference keeps its digits.
    chain.origin_per_travel.col(0) = (at(1000, 0, 0, 0).translation_mm - zero.translation_mm) / 1000.0;
    chain.origin_per_travel.col(1) = (at(0, 1000, 0, 0).translation_mm - zero.translation_mm) / 1000.0;
    chain.origin_per_travel.col(2) = (at(0, 0, 1000, 0).translation_mm - zero.translation_mm) / 1000.0;
    chain.origin_per_s = (at(0, 0, 0, 3600).translation_mm - zero.translation_mm) / 3600.0;
    chain.beam_in_stage = zero.rotation * true_beam_direction(nominal_, values_);
    chain_ = chain;
  }
  if (!table_varies_) table_ = SteadyTable{theta_rad, part_from_stage(theta_rad, values_)};
}

RigidTransform TrueMachine::part_from_stage(double theta_rad, const ErrorValues& values) const {
  return (true_stage_from_mcs(nominal_, theta_rad, values) *
          true_mcs_from_part(nominal_mcs_from_part_, mcs_from_fixture_, values))
      .inverse();
}

TrueMachine::Beam TrueMachine::beam_at(const AxisPositions& encoders, const AxisPositions& velocity_per_s,
                                       double time_s, std::uint64_t point) const {
  ErrorValues values = values_;
  draw_errors(errors_, per_point_, point_stream_, point, values);
  const double late_s = values[ErrorSource::time_base];
  const AxisPositions axes{
      encoders.x_mm + late_s * velocity_per_s.x_mm, encoders.y_mm + late_s * velocity_per_s.y_mm,
      encoders.z_mm + late_s * velocity_per_s.z_mm, encoders.theta_rad + late_s * velocity_per_s.theta_rad};

  Vec3 origin_stage_mm, beam_stage;
  if (chain_) {
    origin_stage_mm = chain_->origin_at_zero_mm +
                      chain_->origin_per_travel * Vec3(axes.x_mm, axes.y_mm, axes.z_mm) +
                      time_s * chain_->origin_per_s;
    beam_stage = chain_->beam_in_stage;
  } else {
    const RigidTransform chain = true_stage_from_probe(nominal_, axes, values, time_s);
    origin_stage_mm = chain.translation_mm;
    beam_stage = chain.rotation * true_beam_direction(nominal_, values);
  }
  const bool table_stands = table_ && table_->theta_rad == axes.theta_rad;
  const RigidTransform part_from_stage_now =
      table_stands ? table_->part_from_stage : part_from_stage(axes.theta_rad, values);

  Beam beam;
  beam.in_part = {part_from_stage_now * origin_stage_mm, part_from_stage_now.rotation * beam_stage};
  beam.velocity_in_part_mm_per_s =
      part_from_stage_now.rotation *
      (nominal_.axis_direction[0] * velocity_per_s.x_mm + nominal_.axis_direction[1] * velocity_per_s.y_mm +
       nominal_.axis_direction[2] * velocity_per_s.z_mm);
  beam.distance_error_mm = values[ErrorSource::sensor_distance];
  return beam;
}

RigidTransform TrueMachine::mcs_from_part() const {
  return true_mcs_from_part(nominal_mcs_from_part_, mcs_from_fixture_, values_);
}

}  // namespace trueblade
