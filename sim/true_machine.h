// The true machine in operation: the chain of true_geometry.h with the draws of the present set-up, view and
// line, and fresh draws per point. What does not change from point to point is worked out once per line.
#pragma once

#include <optional>
#include <vector>

#include "geometry/random.h"
#include "hardware/machine_geometry.h"
#include "sim/machine_errors.h"

namespace trueblade {

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
  // Encoders at `axes`, moving at `velocity_per_s`, `time_s` after the machine was switched on; `point`
  // numbers the draw. Const: points of a line may be computed in any order and on any number of threads.
  Beam beam_at(const AxisPositions& axes, const AxisPositions& velocity_per_s, double time_s,
               std::uint64_t point) const;

  // Where the part truly stands, by the draws of the present view and line.
  RigidTransform mcs_from_part() const;

 private:
  // The probe while its errors stand still: a fixed beam, and an origin that is linear in travel and time.
  struct SteadyChain {
    Vec3 origin_at_zero_mm;
    Mat3 origin_per_travel;  // columns: per mm of x, y, z
    Vec3 origin_per_s;       // thermal drift
    Vec3 beam_in_stage;      // direction
  };
  // The table and the part on it, at one rotary angle.
  struct SteadyTable {
    double theta_rad;
    RigidTransform part_from_stage;
  };
  void work_out(double theta_rad);
  RigidTransform part_from_stage(double theta_rad, const ErrorValues& values) const;

  MachineGeometry nominal_;
  RigidTransform nominal_mcs_from_part_, mcs_from_fixture_;
  MachineErrors errors_;
  std::uint64_t seed_, trial_;
  ErrorValues values_;  // of the present set-up, view and line

  std::vector<ErrorSource> per_point_;  // sources to draw for each point, ascending
  Rng point_stream_;
  bool probe_chain_varies_ = false;  // a source of the chain, or of the beam, is drawn for each point
  bool table_varies_ = false;
  std::optional<SteadyChain> chain_;  // present unless it varies
  std::optional<SteadyTable> table_;
};

}  // namespace trueblade
