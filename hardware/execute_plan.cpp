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
  const auto check = [&](const std::vector<AxisPositions>& positions, const std::string& what) {
    for (const AxisPositions& at : positions)
      if (!limits.contains(at))
        throw InputError(fmt::format("view {}: {} leaves the machine's travel: {}", plan.view, what,
                                     describe_violation(at, limits)));
  };
  for (std::size_t line = 0; line < plan.lines.size(); ++line) {
    check(plan.lines[line].approach, fmt::format("the way to planned line {}", line + 1));
    check(plan.lines[line].path, fmt::format("planned line {}", line + 1));
  }
  check(plan.retreat, "the retreat");
}

ViewScan execute_plan(MachineDriver& driver, const MachineGeometry& geometry, const ScanPlan& plan,
                      const ScanProgress& progress) {
  prepare(driver);
  check_travel(plan, driver.limits());

  ViewScan scan;
  scan.view = plan.view;
  scan.theta_rad = plan.theta_rad;
  scan.columns = plan.columns;
  scan.rows = plan.rows;
  const std::size_t planned = plan.point_count();
  scan.samples.reserve(planned);

  bool keep_going = true;
  const SampleSink collect = [&](const ProbeSample& sample) {
    scan.samples.push_back(sample);
    keep_going = !progress || progress(scan.samples.size(), planned);
    return keep_going;
  };
  try {
    for (const PlannedLine& line : plan.lines) {
      if (line.path.empty()) continue;
      for (const AxisPositions& at : line.approach) driver.move_to(at);
      driver.move_to(line.path.front());
      driver.scan_line(line.path, collect);
      if (!keep_going) break;
    }
    if (keep_going)
      for (const AxisPositions& at : plan.retreat) driver.move_to(at);
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
