#include "sim/true_machine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

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

// Shifts of the probe: they move the origin of the beam in proportion, and nothing else.
bool is_shift_of_probe(ErrorSource source) {
  const auto within = [&](ErrorSource first, ErrorSource last) { return source >= first && source <= last; };
  return within(ErrorSource::probe_x, ErrorSource::probe_z) || within(ErrorSource::exx, ErrorSource::ezx) ||
         within(ErrorSource::exy, ErrorSource::ezy) || within(ErrorSource::exz, ErrorSource::ezz);
}

bool turns_probe(ErrorSource source) {
  const bool of_chain = (source >= ErrorSource::probe_x && source <= ErrorSource::a0z) ||
                        (source >= ErrorSource::drift_x && source <= ErrorSource::drift_z);
  return of_chain && !is_shift_of_probe(source);
}

// Points whose errors are drawn together: their draws (up to 53 sources) stay in the cache.
constexpr std::size_t kPointsTogether = 64;

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
    if (source == ErrorSource::time_base) time_base_drawn_as_ = per_point_.size();
    if (source == ErrorSource::sensor_distance) distance_drawn_as_ = per_point_.size();
    per_point_.push_back(source);
    table_varies_ = table_varies_ || is_of_table(source);
    probe_turns_ = probe_turns_ || turns_probe(source);
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
  if (!probe_turns_) {
    // The chain is linear: one evaluation per variable tells all of it, each from 1 m or 1 h, so that the
    // difference keeps its digits.
    constexpr double kFar = 1000.0, kLong = 3600.0;
    const auto at = [&](const AxisPositions& axes, const ErrorValues& values, double time_s) {
      return true_stage_from_probe(nominal_, axes, values, time_s);
    };
    const RigidTransform zero = at({}, values_, 0.0);
    SteadyChain chain;
    chain.origin_at_zero_mm = zero.translation_mm;
    const auto slope = [&](const RigidTransform& far, double distance) {
      return Vec3((far.translation_mm - zero.translation_mm) / distance);
    };
    chain.origin_per_travel.col(0) = slope(at({kFar, 0, 0, 0}, values_, 0.0), kFar);
    chain.origin_per_travel.col(1) = slope(at({0, kFar, 0, 0}, values_, 0.0), kFar);
    chain.origin_per_travel.col(2) = slope(at({0, 0, kFar, 0}, values_, 0.0), kFar);
    chain.origin_per_s = slope(at({}, values_, kLong), kLong);
    for (const ErrorSource source : per_point_) {
      ErrorValues shifted = values_;
      shifted[source] = kFar;
      chain.origin_per_value.push_back(is_shift_of_probe(source) ? slope(at({}, shifted, 0.0), kFar)
                                                                 : Vec3(Vec3::Zero()));
    }
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

TrueMachine::Beam TrueMachine::beam_at(const AxisState& at, std::uint64_t point) const {
  Beam beam;
  beams_at({&at, 1}, point, {&beam, 1});
  return beam;
}

void TrueMachine::beams_at(std::span<const AxisState> at, std::uint64_t first_point,
                           std::span<Beam> beams) const {
  std::array<double, kErrorSourceCount * kPointsTogether> draws;
  for (std::size_t begin = 0; begin < at.size(); begin += kPointsTogether) {
    const std::size_t count = std::min(kPointsTogether, at.size() - begin);
    const std::span<double> drawn(draws.data(), per_point_.size() * count);
    draw_errors(errors_, per_point_, point_stream_, first_point + begin, count, drawn);
    for (std::size_t k = 0; k < count; ++k)
      beams[begin + k] = beam_with(at[begin + k], drawn.subspan(k), count);
  }
}

TrueMachine::Beam TrueMachine::beam_with(const AxisState& at, std::span<const double> drawn,
                                         std::size_t stride) const {
  // All the errors of this point, for what is not steady.
  const auto values = [&] {
    ErrorValues all = values_;
    for (std::size_t s = 0; s < per_point_.size(); ++s) all[per_point_[s]] = drawn[s * stride];
    return all;
  };
  const auto value = [&](ErrorSource source, std::optional<std::size_t> drawn_as) {
    return drawn_as ? drawn[*drawn_as * stride] : values_[source];
  };
  const double late_s = value(ErrorSource::time_base, time_base_drawn_as_);
  const AxisPositions axes{at.axes.x_mm + late_s * at.velocity_per_s.x_mm,
                           at.axes.y_mm + late_s * at.velocity_per_s.y_mm,
                           at.axes.z_mm + late_s * at.velocity_per_s.z_mm,
                           at.axes.theta_rad + late_s * at.velocity_per_s.theta_rad};

  Vec3 origin_stage_mm, beam_stage;
  if (chain_) {
    origin_stage_mm = chain_->origin_at_zero_mm +
                      chain_->origin_per_travel * Vec3(axes.x_mm, axes.y_mm, axes.z_mm) +
                      at.time_s * chain_->origin_per_s;
    for (std::size_t s = 0; s < per_point_.size(); ++s)
      origin_stage_mm += drawn[s * stride] * chain_->origin_per_value[s];
    beam_stage = chain_->beam_in_stage;
  } else {
    const ErrorValues now = values();
    const RigidTransform chain = true_stage_from_probe(nominal_, axes, now, at.time_s);
    origin_stage_mm = chain.translation_mm;
    beam_stage = chain.rotation * true_beam_direction(nominal_, now);
  }
  const bool table_stands = table_ && table_->theta_rad == axes.theta_rad;
  const RigidTransform part_from_stage_now =
      table_stands ? table_->part_from_stage : part_from_stage(axes.theta_rad, values());

  Beam beam;
  beam.in_part = {part_from_stage_now * origin_stage_mm, part_from_stage_now.rotation * beam_stage};
  beam.velocity_in_part_mm_per_s =
      part_from_stage_now.rotation * (nominal_.axis_direction[0] * at.velocity_per_s.x_mm +
                                      nominal_.axis_direction[1] * at.velocity_per_s.y_mm +
                                      nominal_.axis_direction[2] * at.velocity_per_s.z_mm);
  beam.distance_error_mm = value(ErrorSource::sensor_distance, distance_drawn_as_);
  return beam;
}

RigidTransform TrueMachine::mcs_from_part() const {
  ErrorValues of_view = values_;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    const ErrorScope scope = errors_[source].scope;
    if (scope == ErrorScope::line || scope == ErrorScope::point) of_view[source] = errors_[source].mean;
  }
  return true_mcs_from_part(nominal_mcs_from_part_, mcs_from_fixture_, of_view);
}

}  // namespace trueblade
