#include "sim/true_machine.h"

#include <algorithm>
#include <array>

namespace trueblade {
namespace {

bool is_active(const GaussianError& error) {
  return error.mean != 0.0 || error.sigma != 0.0;
}

bool is_of_table(ErrorSource source) {
  return (source >= ErrorSource::part_x && source <= ErrorSource::fixture_c) ||
         (source >= ErrorSource::exc && source <= ErrorSource::boc);
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
    const TrueProbeChain chain = true_probe_chain(nominal_, values_);
    std::vector<Vec3> per_value;
    for (const ErrorSource source : per_point_) per_value.push_back(origin_per_value(chain, source));
    probe_ =
        SteadyProbe{chain, std::move(per_value), chain.rotation * true_beam_direction(nominal_, values_)};
  }
  if (!table_varies_) table_ = SteadyTable{theta_rad, part_from_stage(theta_rad, values_)};
}

TrueMachine::Table TrueMachine::part_from_stage(double theta_rad, const ErrorValues& values) const {
  const RigidTransform transform = (true_stage_from_mcs(nominal_, theta_rad, values) *
                                    true_mcs_from_part(nominal_mcs_from_part_, mcs_from_fixture_, values))
                                       .inverse();
  return {transform.rotation.toRotationMatrix(), transform.translation_mm};
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
    beams_with(at.subspan(begin, count), drawn, beams.subspan(begin, count));
  }
}

ErrorValues TrueMachine::errors_of(std::span<const double> drawn, std::size_t count, std::size_t k) const {
  ErrorValues all = values_;
  for (std::size_t s = 0; s < per_point_.size(); ++s) all[per_point_[s]] = drawn[s * count + k];
  return all;
}

void TrueMachine::beams_with(std::span<const AxisState> at, std::span<const double> drawn,
                             std::span<Beam> beams) const {
  const std::size_t count = at.size();
  const auto value = [&](ErrorSource source, std::optional<std::size_t> drawn_as, std::size_t k) {
    return drawn_as ? drawn[*drawn_as * count + k] : values_[source];
  };

  // Component by component through all points: the compiler makes vectors of it.
  std::array<std::array<double, kPointsTogether>, 3> shift_mm{};
  if (probe_)
    for (std::size_t s = 0; s < per_point_.size(); ++s) {
      if (!is_shift_of_probe(per_point_[s])) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double per_value = probe_->origin_per_value[s][static_cast<Eigen::Index>(axis)];
        const double* const values = drawn.data() + s * count;
        for (std::size_t k = 0; k < count; ++k) shift_mm[axis][k] += per_value * values[k];
      }
    }

  const Mat3 directions = axis_directions(nominal_);
  const Vec3 steady_beam =
      probe_ && table_ ? Vec3(table_->part_from_stage.rotation * probe_->beam_in_stage) : Vec3(Vec3::Zero());
  for (std::size_t k = 0; k < count; ++k) {
    const double late_s = value(ErrorSource::time_base, time_base_drawn_as_, k);
    const AxisPositions& reported = at[k].axes;
    const AxisPositions& speed = at[k].velocity_per_s;
    const Vec3 velocity_mm_per_s(speed.x_mm, speed.y_mm, speed.z_mm);
    const Vec3 travel_mm = Vec3(reported.x_mm, reported.y_mm, reported.z_mm) + late_s * velocity_mm_per_s;
    const double theta_rad = reported.theta_rad + late_s * speed.theta_rad;
    const bool table_stands = table_ && table_->theta_rad == theta_rad;
    const Table part_from_stage_now =
        table_stands ? table_->part_from_stage : part_from_stage(theta_rad, errors_of(drawn, count, k));

    Beam& beam = beams[k];
    Vec3 origin_stage_mm;
    if (probe_) {
      const TrueProbeChain& chain = probe_->chain;
      origin_stage_mm = chain.origin_at_zero_mm + chain.origin_per_travel * travel_mm +
                        at[k].time_s * chain.origin_per_s_mm +
                        Vec3(shift_mm[0][k], shift_mm[1][k], shift_mm[2][k]);
      beam.in_part.direction =
          table_stands ? steady_beam : Vec3(part_from_stage_now.rotation * probe_->beam_in_stage);
    } else {
      const ErrorValues now = errors_of(drawn, count, k);
      const AxisPositions axes{travel_mm.x(), travel_mm.y(), travel_mm.z(), theta_rad};
      const RigidTransform stage_from_probe = true_stage_from_probe(nominal_, axes, now, at[k].time_s);
      origin_stage_mm = stage_from_probe.translation_mm;
      beam.in_part.direction =
          part_from_stage_now.rotation * (stage_from_probe.rotation * true_beam_direction(nominal_, now));
    }
    beam.in_part.origin_mm =
        part_from_stage_now.rotation * origin_stage_mm + part_from_stage_now.translation_mm;
    beam.velocity_in_part_mm_per_s = part_from_stage_now.rotation * (directions * velocity_mm_per_s);
    beam.distance_error_mm = value(ErrorSource::sensor_distance, distance_drawn_as_, k);
  }
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
