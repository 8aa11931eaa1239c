// The true machine in operation: the chain of true_geometry.h with the draws of the present set-up, view and
// line, and fresh draws per point. What does not change from point to point is worked out once per line.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/random.h"
#include "hardware/machine_geometry.h"
#include "sim/machine_errors.h"
#include "sim/true_geometry.h"

namespace trueblade {

// What the encoders say when a sample is taken, `time_s` after the machine was switched on.
struct AxisState {
  AxisPositions axes;
  AxisPositions velocity_per_s;
  double time_s = 0.0;
};

class TrueMachine {
 public:
  TrueMachine(const MachineGeometry& nominal, const RigidTransform& nominal_mcs_from_part,
              const RigidTransform& mcs_from_fixture, const MachineErrors& errors, std::uint64_t seed,
              std::uint64_t trial);

  // Draw the errors of view or line number `index` and work out the chain at the rotary angle where points
  // are about to be taken.
  void begin_view(std::uint64_t index, double theta_rad);
  void begin_line(std::uint64_t index, double theta_rad);

  // The beam at one point, in the true part's frame.
  struct Beam {
    Ray in_part;
    Vec3 velocity_in_part_mm_per_s;  // of the probe against the part, by the linear axes
    double distance_error_mm;
  };
  // The beams at points number `first_point` and up. Const: points of a line may be computed in any order, in
  // any groups, and on any number of threads. Precondition: beams.size() == at.size().
  void beams_at(std::span<const AxisState> at, std::uint64_t first_point, std::span<Beam> beams) const;
  Beam beam_at(const AxisState& at, std::uint64_t point) const;

  // Where the part truly stands in the present view: by the draws of the set-up and the view. What is drawn
  // for every line or point is a part that moves meanwhile: its mean counts.
  RigidTransform mcs_from_part() const;

 private:
  // While no rotation of the probe is drawn for each point.
  struct SteadyProbe {
    TrueProbeChain chain;
    std::vector<Vec3> origin_per_value;  // of each of per_point_
    Vec3 beam_in_stage;                  // direction
  };
  // The table and the part on it, at one rotary angle.
  struct Table {
    Mat3 rotation;  // of part_from_stage
    Vec3 translation_mm;
  };
  struct SteadyTable {
    double theta_rad;
    Table part_from_stage;
  };
  void work_out(double theta_rad);
  // With the draws of per_point_ for point k at drawn[k], drawn[at.size() + k], ...
  void beams_with(std::span<const AxisState> at, std::span<const double> drawn, std::span<Beam> beams) const;
  // All the errors of point k.
  ErrorValues errors_of(std::span<const double> drawn, std::size_t count, std::size_t k) const;
  Table part_from_stage(double theta_rad, const ErrorValues& values) const;

  MachineGeometry nominal_;
  RigidTransform nominal_mcs_from_part_, mcs_from_fixture_;
  MachineErrors errors_;
  std::uint64_t seed_, trial_;
  ErrorValues values_;  // of the present set-up, view and line

  std::vector<ErrorSource> per_point_;  // sources to draw for each point, ascending
  std::optional<std::size_t> time_base_drawn_as_, distance_drawn_as_;  // places in per_point_
  Rng point_stream_;
  bool probe_turns_ = false;   // a rotation of the chain or of the beam, or a drift, is drawn for each point
  bool table_varies_ = false;  // a source of the table is
  std::optional<SteadyProbe> probe_;  // present unless the probe turns
  std::optional<SteadyTable> table_;
};

}  // namespace trueblade
