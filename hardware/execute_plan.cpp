#include "hardware/execute_plan.h"

#include <fmt/core.h>

#include <numbers>

#include "geometry/error.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string describe_violation(const AxisPositions& at, const AxisLimits& limits) {
  const auto& [low, high] = limits;
  const auto outside = [](double lower, double value, double upper) {
    return !(lower <= value && value <= upper);
  };
  if (outside(low.x_mm, at.x_mm, high.x_mm))
    return fmt::format("x is {:.3f} mm, must be within {:.3f} and {:.3f} mm", at.x_mm, low.x_mm, high.x_mm);
  if (outside(low.y_mm, at.y_mm, high.y_mm))
    return fmt::format("y is {:.3f} mm, must be within {:.3f} and {:.3f} mm", at.y_mm, low.y_mm, high.y_mm);
  if (outside(low.z_mm, at.z_mm, high.z_mm))
    return fmt::format("z is {:.3f} mm, must be within {:.3f} and {:.3f} mm", at.z_mm, low.z_mm, high.z_mm);
  return fmt::format("theta is {:.3f} deg, must be within {:.3f} and {:.3f} deg", at.theta_rad / kDegree,
                     low.theta_rad / kDegree, high.theta_rad / kDegree);
}

void prepare(MachineDriver& driver) {
  if (driver.state() == MachineState::disconnected) driver.connect();
  if (driver.state() == MachineState::not_homed) driver.home();
}

// Where in the plan the next sample is taken.
struct NextSample {
  std::size_t line = 0, position = 0;
};

NextSample after(const ScanPlan& plan, std::size_t samples) {
  NextSample next;
  for (; next.line < plan.lines.size(); ++next.line) {
    const std::size_t length = plan.lines[next.line].path.size();
    if (samples < length) break;
    samples -= length;
  }
  next.position = samples;
  return next;
}

// The same rotary angle and place across the beam, but the probe withdrawn along the beam to the depth at
// which the plan leaves the part.
AxisPositions withdrawn(const MachineGeometry& geometry, const ScanPlan& plan, const AxisPositions& at) {
  if (plan.retreat.empty()) return at;
  Mat3 directions;
  for (int k = 0; k < 3; ++k) directions.col(k) = geometry.axis_direction[static_cast<std::size_t>(k)];
  const Vec3 beam = geometry.stage_from_probe_at_zero.rotation * geometry.beam_direction;
  const auto depth = [&](const AxisPositions& axes) {
    return beam.dot(directions * Vec3(axes.x_mm, axes.y_mm, axes.z_mm));
  };
  constexpr double kRoundingMm = 1e-6;  // of positions that stand at that depth
  const double too_deep_mm = depth(at) - depth(plan.retreat.back());
  if (too_deep_mm <= kRoundingMm) return at;
  const Vec3 travel = directions.inverse() * (-too_deep_mm * beam);
  return {at.x_mm + travel.x(), at.y_mm + travel.y(), at.z_mm + travel.z(), at.theta_rad};
}

bool same_place(const AxisPositions& a, const AxisPositions& b) {
  return a.x_mm == b.x_mm && a.y_mm == b.y_mm && a.z_mm == b.z_mm && a.theta_rad == b.theta_rad;
}

// From wherever the machine stands to the line of the next sample. Where that line broke off, the last
// position measured before comes first, so that the next one is passed in the same motion as without the
// break.
std::vector<AxisPositions> first_way(const MachineGeometry& geometry, const ScanPlan& plan,
                                     const NextSample& next, bool resumed, const AxisPositions& at) {
  std::vector<AxisPositions> way;
  const AxisPositions free = withdrawn(geometry, plan, at);
  if (!same_place(free, at)) way.push_back(free);
  const PlannedLine& line = plan.lines[next.line];
  const AxisPositions& target = line.path[next.position == 0 ? 0 : next.position - 1];
  if (resumed)
    way.push_back(withdrawn(geometry, plan, target));
  else
    way.insert(way.end(), line.approach.begin(), line.approach.end());
  way.push_back(target);
  return way;
}

void check_positions(const ScanPlan& plan, std::span<const AxisPositions> positions, const AxisLimits& limits,
                     const std::string& what) {
  for (const AxisPositions& at : positions)
    if (!limits.contains(at))
      throw InputError(fmt::format("view {}: {} leaves the machine's travel: {}", plan.view, what,
                                   describe_violation(at, limits)));
}

void convert_usable_samples(const MachineGeometry& geometry, ViewScan& scan) {
  for (std::size_t i = 0; i < scan.samples.size(); ++i) {
    const ProbeSample& sample = scan.samples[i];
    if (!sample.flags.usable()) continue;
    scan.usable.push_back(static_cast<std::uint32_t>(i));
    scan.points.position_mcs_mm.push_back(point_in_mcs_mm(geometry, sample));
    scan.points.snr.push_back(sample.snr);
  }
}

}  // namespace

void check_travel(const ScanPlan& plan, const AxisLimits& limits) {
  for (std::size_t line = 0; line < plan.lines.size(); ++line) {
    check_positions(plan, plan.lines[line].approach, limits,
                    fmt::format("the way to planned line {}", line + 1));
    check_positions(plan, plan.lines[line].path, limits, fmt::format("planned line {}", line + 1));
  }
  check_positions(plan, plan.retreat, limits, "the retreat");
}

ViewScan execute_plan(MachineDriver& driver, const MachineGeometry& geometry, const ScanPlan& plan,
                      const ExecutionOptions& options) {
  const std::size_t planned = plan.point_count();
  const std::size_t before = options.measured_before.size();
  if (before > planned)
    throw InputError(fmt::format("view {}: {} samples were measured before, only {} are planned", plan.view,
                                 before, planned));
  prepare(driver);
  check_travel(plan, driver.limits());

  ViewScan scan;
  scan.view = plan.view;
  scan.theta_rad = plan.theta_rad;
  scan.columns = plan.columns;
  scan.rows = plan.rows;
  scan.samples.reserve(planned);
  scan.samples = options.measured_before;
  const NextSample next = after(plan, before);
  if (before > 0) {
    MeasuredBefore skipped{plan.theta_rad, next.line, before};
    if (next.position > 0) skipped.of_line = std::span(plan.lines[next.line].path).first(next.position);
    driver.skip_measured(skipped);
  }

  std::vector<AxisPositions> way;
  if (next.line < plan.lines.size()) {
    way = first_way(geometry, plan, next, before > 0, driver.position());
    check_positions(plan, way, driver.limits(), "the way from where the machine stands");
    if (options.check_first_way) options.check_first_way(driver.position(), way);
  }

  const auto stop_asked = [&] { return options.stop_asked && options.stop_asked(); };
  bool keep_going = true;
  const SampleSink collect = [&](const ProbeSample& sample) {
    if (options.keep) options.keep(sample);
    scan.samples.push_back(sample);
    keep_going = !options.progress || options.progress(scan.samples.size(), planned);
    return keep_going;
  };
  try {
    for (std::size_t k = next.line; k < plan.lines.size() && keep_going; ++k) {
      const PlannedLine& line = plan.lines[k];
      if (line.path.empty()) continue;
      if (k != next.line) {
        way = line.approach;
        way.push_back(line.path.front());
      }
      driver.move_through(way);
      driver.scan_line(std::span(line.path).subspan(k == next.line ? next.position : 0), collect);
      keep_going = keep_going && !stop_asked();
    }
    if (keep_going && before < planned) driver.move_through(plan.retreat);
  } catch (const MachineFault& fault) {
    driver.stop();
    if (fault.kind() != MachineFault::Kind::interrupted || !stop_asked()) throw;
    keep_going = false;
  } catch (...) {
    driver.stop();
    throw;
  }
  if (!keep_going) driver.stop();

  scan.complete = scan.samples.size() == planned;
  scan.grid_index.assign(plan.grid_index.begin(),
                         plan.grid_index.begin() + static_cast<std::ptrdiff_t>(scan.samples.size()));
  convert_usable_samples(geometry, scan);
  if (!scan.samples.empty()) scan.time_s = scan.samples.back().time_s - scan.samples.front().time_s;
  return scan;
}

}  // namespace trueblade
