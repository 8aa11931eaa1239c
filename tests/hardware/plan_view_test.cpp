// Plans: they follow known surfaces at standoff, keep to the raster, the chosen surfaces and the incidence
// limit, turn with the table and with the part, and refuse what cannot be planned.
#include "hardware/plan_view.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "geometry/error.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;

// Where the beam of a planned position meets standoff: it must be on the surface.
std::vector<Vec3> planned_points(const MachineGeometry& geometry, const Lens& lens, const ScanPlan& plan) {
  std::vector<Vec3> points;
  for (const PlannedLine& line : plan.lines)
    for (const AxisPositions& axes : line.path) {
      ProbeSample sample;
      sample.axes = axes;
      sample.distance_mm = lens.standoff_mm;
      points.push_back(point_in_mcs_mm(geometry, sample));
    }
  return points;
}

TEST(PlanView, APlateIsCoveredByAFullBoustrophedonRaster) {
  const Part part = testing::plate(3.0, 10.0);
  const RayCaster caster(part.model);
  const MachineGeometry geometry;
  const Lens lens = standard_lens("25mm");
  PlanOptions options;
  options.spacing_mm = 1.5;  // floor(10 / 1.5) + 1 = 7 each way
  const ScanPlan plan = plan_view(geometry, lens, part, caster, {}, options);

  EXPECT_EQ(plan.columns, 7u);
  EXPECT_EQ(plan.rows, 7u);
  ASSERT_EQ(plan.point_count(), 49u);
  ASSERT_EQ(plan.grid_index.size(), 49u);
  EXPECT_EQ(std::set(plan.grid_index.begin(), plan.grid_index.end()).size(), 49u);
  for (std::size_t row = 0; row < 7; ++row) {
    const auto& path = plan.lines[row].path;
    const double direction = path[1].x_mm - path[0].x_mm;
    EXPECT_NEAR(std::abs(direction), 1.5, 1e-12);
    if (row > 0) {
      const AxisPositions& before = plan.lines[row - 1].path.back();
      EXPECT_NEAR(path[0].x_mm, before.x_mm, 1e-12);  // the next line starts beside the last one's end
      EXPECT_NEAR(std::abs(path[0].z_mm - before.z_mm), 1.5, 1e-12);
    }
    for (const AxisPositions& axes : path) EXPECT_NEAR(axes.y_mm, 28.0, 1e-12);
  }
}

TEST(PlanView, RowsAreSpreadOverTheWorkingRange) {
  const Part part = testing::plate(3.0, 10.0);
  const RayCaster caster(part.model);
  PlanOptions options;
  options.spacing_mm = 1.5;
  options.standoff_spread_mm = 0.25;
  const ScanPlan plan = plan_view({}, standard_lens("25mm"), part, caster, {}, options);
  ASSERT_EQ(plan.lines.size(), 7u);
  std::array<int, 3> rows{};  // nearer, at the standoff, farther
  for (const PlannedLine& line : plan.lines) {
    const double off_mm = line.path.front().y_mm - 28.0;
    for (const AxisPositions& axes : line.path) EXPECT_NEAR(axes.y_mm - 28.0, off_mm, 1e-12);
    const long step = std::lround(off_mm / 0.25);
    EXPECT_NEAR(off_mm, 0.25 * static_cast<double>(step), 1e-12);
    ++rows.at(static_cast<std::size_t>(step + 1));
  }
  EXPECT_EQ(rows, (std::array{3, 2, 2}));
}

TEST(PlanView, TheProbeFollowsASphereAtStandoff) {
  const double radius_mm = 10.0;
  const Part part = testing::sphere(radius_mm);
  const RayCaster caster(part.model);
  MachineGeometry geometry;
  geometry.rotary_axis_point_mm = {4.0, -2.0, 0.0};
  geometry.stage_from_probe_at_zero.translation_mm = {0.0, 100.0, 0.0};
  const Lens lens = standard_lens("25mm");
  PlanOptions options;
  options.spacing_mm = 0.7;
  options.theta_rad = 0.9;
  options.max_incidence_rad = 60.0 * kPi / 180.0;
  RigidTransform part_from_mcs;
  part_from_mcs.rotation = rotation_from_vector({0.3, -0.2, 0.5});
  part_from_mcs.translation_mm = {1.0, 2.0, 3.0};
  const ScanPlan plan = plan_view(geometry, lens, part, caster, part_from_mcs, options);

  // Facets of 3 degrees (60 rings) lie inside the sphere by up to 2 * r (1 - cos 1.5 deg) = 0.0069 mm at the
  // middle of a square cell; the working range is 100 times as long.
  for (const Vec3& point : planned_points(geometry, lens, plan)) {
    const double r = (part_from_mcs * point).norm();
    EXPECT_LE(r, radius_mm + 1e-12);
    EXPECT_GE(r, radius_mm - 0.0069);
  }
  // Incidence within 60 deg leaves the disc of radius r sin(60 deg); a facet's normal is up to 2.2 deg from
  // the sphere's, so that the count lies between those of discs at 57.8 and 62.2 deg, and a rim of cells
  // (half a spacing either way).
  const auto disc_cells = [&](double degrees, double rim_mm) {
    const double disc_radius_mm = radius_mm * std::sin(degrees * kPi / 180.0) + rim_mm;
    return kPi * disc_radius_mm * disc_radius_mm / (0.7 * 0.7);
  };
  EXPECT_GT(static_cast<double>(plan.point_count()), disc_cells(57.8, -0.35));
  EXPECT_LT(static_cast<double>(plan.point_count()), disc_cells(62.2, 0.35));
}

TEST(PlanView, OnlyTheChosenSurfacesAreMeasured) {
  const Part part = testing::plate(0.0, 10.0);
  const RayCaster caster(part.model);
  PlanOptions options;
  options.spacing_mm = 0.9;
  options.surfaces = {1};  // x > 0
  const MachineGeometry geometry;
  const Lens lens = standard_lens("25mm");
  const ScanPlan plan = plan_view(geometry, lens, part, caster, {}, options);
  ASSERT_GT(plan.point_count(), 0u);
  for (const Vec3& point : planned_points(geometry, lens, plan)) EXPECT_GE(point.x(), 0.0);
}

TEST(PlanView, TheBackOfAPlateCannotBeSeen) {
  const Part part = testing::plate(0.0, 10.0);
  const RayCaster caster(part.model);
  PlanOptions options;
  options.theta_rad = kPi;
  EXPECT_THROW(plan_view({}, standard_lens("25mm"), part, caster, {}, options), NothingToMeasure);
}

TEST(PlanView, ABeamAlongTheRotaryAxisStillHasARaster) {
  const Part part = testing::sphere(5.0);
  const RayCaster caster(part.model);
  MachineGeometry geometry;
  geometry.beam_direction = -Vec3::UnitZ();
  const Lens lens = standard_lens("100mm");
  const ScanPlan plan = plan_view(geometry, lens, part, caster, {}, {});
  EXPECT_EQ(plan.columns, 11u);  // 10 mm at 1 mm
  for (const Vec3& point : planned_points(geometry, lens, plan)) EXPECT_GT(point.z(), 0.0);
}

// All motions of a plan in order: the withdrawn start, ways between lines, lines, retreat.
std::vector<AxisPositions> all_positions(const ScanPlan& plan) {
  std::vector<AxisPositions> all;
  for (const PlannedLine& line : plan.lines) {
    all.insert(all.end(), line.approach.begin(), line.approach.end());
    all.insert(all.end(), line.path.begin(), line.path.end());
  }
  all.insert(all.end(), plan.retreat.begin(), plan.retreat.end());
  return all;
}

TEST(PlanView, TheHousingKeepsItsClearanceOnEveryWay) {
  // The wall is higher than the standoff, so that the housing must withdraw to get across.
  const Part part = testing::plate_with_wall(40.0);
  const RayCaster caster(part.model);
  MachineGeometry geometry;
  geometry.rotary_axis_point_mm = {0.0, 10.0, 0.0};
  PlanOptions options;
  options.spacing_mm = 1.3;
  options.probe = {.radius_mm = 3.0, .length_mm = 60.0, .aperture_radius_mm = 1.0, .clearance_mm = 0.5};
  const ScanPlan plan = plan_view(geometry, standard_lens("25mm"), part, caster, {}, options);

  std::size_t withdrawals = 0;
  for (const PlannedLine& line : plan.lines) withdrawals += line.approach.size() == 2 ? 1 : 0;
  EXPECT_GT(withdrawals, 0u);
  EXPECT_GT(plan.cells[static_cast<std::size_t>(PointAccess::probe_touches)], 0u);
  EXPECT_EQ(plan.cells[static_cast<std::size_t>(PointAccess::measurable)], plan.point_count());

  // Within the resolution of the march.
  ProbeBody smaller = options.probe;
  smaller.clearance_mm -= ProbeClearance::kResolutionMm;
  const ProbeClearance clearance(part.model, smaller);
  const auto positions = all_positions(plan);
  for (std::size_t k = 1; k < positions.size(); ++k) {
    const Ray from = beam_in_mcs(geometry, positions[k - 1]), to = beam_in_mcs(geometry, positions[k]);
    EXPECT_TRUE(clearance.way_is_free(from.origin_mm, to.origin_mm, to.direction)) << k;
  }
}

TEST(PlanView, AtItsStartAndEndTheTableCanTurn) {
  const Part part = testing::plate_with_wall(40.0);
  const RayCaster caster(part.model);
  MachineGeometry geometry;
  geometry.rotary_axis_point_mm = {5.0, 10.0, 0.0};
  PlanOptions options;
  options.spacing_mm = 5.0;
  const ScanPlan plan = plan_view(geometry, standard_lens("25mm"), part, caster, {}, options);
  const ProbeClearance clearance(part.model, options.probe);
  for (AxisPositions at : {plan.lines.front().approach.front(), plan.retreat.back()})
    for (double theta = -3.1; theta < 3.2; theta += 0.1) {
      at.theta_rad = theta;
      const Ray beam = beam_in_mcs(geometry, at);
      EXPECT_GE(clearance.spare_mm(beam.origin_mm, beam.direction, 100.0), -ProbeClearance::kResolutionMm)
          << theta;
    }
}

TEST(PlanView, ImpossibleOptionsAreRefusedByName) {
  const Part part = testing::plate(0.0, 10.0);
  const RayCaster caster(part.model);
  const auto message_of = [&](const PlanOptions& options) -> std::string {
    try {
      plan_view({}, standard_lens("25mm"), part, caster, {}, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  PlanOptions zero;
  zero.spacing_mm = 0.0;
  EXPECT_NE(message_of(zero).find("spacing_mm is 0"), std::string::npos);
  PlanOptions fine;
  fine.spacing_mm = 1e-9;  // 10^20 cells: refused before memory is asked for
  EXPECT_NE(message_of(fine).find("cells"), std::string::npos);
  PlanOptions unknown;
  unknown.surfaces = {2};
  EXPECT_NE(message_of(unknown).find("surface 2 does not exist"), std::string::npos);
  PlanOptions wide;
  wide.standoff_spread_mm = 0.35;
  EXPECT_NE(message_of(wide).find("standoff_spread_mm is 0.35, must be at least 0 and below 0.35"),
            std::string::npos);
  PlanOptions steep;
  steep.max_incidence_rad = 2.0;
  EXPECT_NE(message_of(steep).find("max_incidence"), std::string::npos);
}

// The top of the wall is 1 mm wide: a raster of 9 mm, centred on the plate, passes it by at 9 and 18 mm. That
// is no matter of sight, and the refusal says so; from behind it is.
TEST(PlanView, ARasterTooCoarseForASurfaceIsCalledThat) {
  const Part part = testing::plate_with_wall(3.0);
  const RayCaster caster(part.model);
  PlanOptions options;
  options.surfaces = {1};
  const auto refusal = [&]() -> std::string {
    try {
      plan_view({}, standard_lens("25mm"), part, caster, {}, options);
    } catch (const NothingToMeasure& refused) {
      return refused.what();
    }
    return "planned";
  };
  options.spacing_mm = 9.0;
  const std::string coarse = refusal();
  EXPECT_NE(coarse.find("spacing_mm is 9, too coarse for the chosen surfaces"), std::string::npos) << coarse;
  EXPECT_NE(coarse.find("1 x 40 mm"), std::string::npos) << coarse;
  options.spacing_mm = 0.5;
  EXPECT_EQ(refusal(), "planned");
  options.spacing_mm = 9.0;
  options.theta_rad = kPi;
  const std::string behind = refusal();
  EXPECT_NE(behind.find("nothing of the chosen surfaces"), std::string::npos) << behind;
  EXPECT_NE(behind.find("faces away"), std::string::npos) << behind;
}

TEST(PlanView, SaysWhatEachPositionMeets) {
  const Part part = testing::sphere(12.0, 200);
  const RayCaster caster(part.model);
  PlanOptions options;
  options.standoff_spread_mm = 0.2;
  const MachineGeometry geometry;
  const ScanPlan plan = plan_view(geometry, standard_lens("25mm"), part, caster, {}, options);
  ASSERT_EQ(plan.points.size(), plan.point_count());
  std::size_t k = 0;
  for (const PlannedLine& line : plan.lines)
    for (const AxisPositions& axes : line.path) {
      const PlannedPoint& point = plan.points[k++];
      // Facets of 0.9 degrees: the normal is off by no more than half of their diagonal.
      const double cosine = std::sqrt(1.0 - (axes.x_mm * axes.x_mm + axes.z_mm * axes.z_mm) / 144.0);
      EXPECT_NEAR(std::acos(point.incidence_cosine), std::acos(cosine), 0.012);
      EXPECT_NEAR(axes.y_mm - point.range_mm, 12.0 * cosine, 0.01);
      EXPECT_EQ(point.surface, 0u);
    }
}

}  // namespace
}  // namespace trueblade
