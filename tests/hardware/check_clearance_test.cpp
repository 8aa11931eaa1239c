// Covers: plans of the planner pass; a plan whose probe would pass through the part, come too close, or stand
// in the way of the turning table is refused with view and move; home inside the part is refused.
#include "hardware/check_clearance.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "hardware/plan_view.h"
#include "tests/hardware/analytic_parts.h"

namespace trueblade {
namespace {

// A ball of 10 mm on the rotary axis; the probe looks along -y and stands 100 mm off at home.
struct Scene {
  Scene() {
    geometry.stage_from_probe_at_zero.translation_mm = {0.0, 100.0, 0.0};
    options.spacing_mm = 2.0;
  }
  Part part = testing::sphere(10.0);
  RayCaster caster{part.model};
  MachineGeometry geometry;
  PlanOptions options;
  RigidTransform part_from_mcs;

  ScanPlan plan() const {
    return plan_view(geometry, standard_lens("25mm"), part, caster, part_from_mcs, options);
  }
  std::string verdict(const ScanPlan& plan, const AxisPositions& start = {}) const {
    try {
      check_clearance(plan, geometry, part.model, part_from_mcs, ProbeClearance(part.model, options.probe),
                      options.probe, start);
    } catch (const InputError& refused) {
      return refused.what();
    }
    return "free";
  }
};

TEST(CheckClearance, PassesWhatThePlannerMade) {
  Scene scene;
  EXPECT_EQ(scene.verdict(scene.plan()), "free");
  scene.options.theta_rad = 2.0;
  EXPECT_EQ(scene.verdict(scene.plan()), "free");
}

TEST(CheckClearance, RefusesALineThroughThePart) {
  const Scene scene;
  ScanPlan plan = scene.plan();
  plan.lines[1].path.push_back(plan.lines[1].path.back());
  plan.lines[1].path.back().y_mm = -100.0;  // the probe origin in the middle of the ball
  const std::string verdict = scene.verdict(plan);
  EXPECT_NE(verdict.find("view front: planned line 2"), std::string::npos) << verdict;
  EXPECT_NE(verdict.find("the probe would touch the part"), std::string::npos) << verdict;
}

// The clearance of 1 mm: the front of the housing at 10.9 mm from the centre is too close, at 11.1 mm it is
// not.
TEST(CheckClearance, KeepsTheClearance) {
  const Scene scene;
  ScanPlan plan;
  plan.view = "probe";
  plan.lines.resize(1);
  plan.lines[0].path = {{0.0, 10.9 - 100.0, 0.0, 0.0}};
  EXPECT_NE(scene.verdict(plan).find("touch"), std::string::npos);
  plan.lines[0].path = {{0.0, 11.1 - 100.0, 0.0, 0.0}};
  EXPECT_EQ(scene.verdict(plan), "free");
}

TEST(CheckClearance, RefusesToTurnThePartIntoTheProbe) {
  const Scene scene;
  ScanPlan plan;
  plan.view = "turn";
  plan.lines.resize(1);
  plan.lines[0].path = {{0.0, 10.5 - 100.0, 0.0, 1.0}};
  EXPECT_NE(scene.verdict(plan).find("the table would turn"), std::string::npos);
}

TEST(CheckClearance, RefusesAHomeInsideThePart) {
  const Scene scene;
  EXPECT_NE(scene.verdict(scene.plan(), {0.0, -100.0, 0.0, 0.0}).find("the way to planned line 1"),
            std::string::npos);
}

// The machine stands beside the ball, or behind it: along the beam it comes free from the side, and not
// through the ball.
TEST(CheckClearance, TheWayFromWhereTheMachineStandsIsHeldAgainstThePart) {
  const Scene scene;
  const ProbeClearance clearance(scene.part.model, scene.options.probe);
  const auto verdict = [&](const AxisPositions& from, const std::vector<AxisPositions>& way) -> std::string {
    try {
      check_first_way("front", scene.geometry, scene.part.model, scene.part_from_mcs, clearance,
                      scene.options.probe, from, way);
    } catch (const InputError& refused) {
      return refused.what();
    }
    return "free";
  };
  // Radii of ball and housing and the clearance: 26 mm from axis to axis. The probe origin lies 20 mm beyond
  // the middle of the ball, the round front of the housing is 15 mm long.
  const AxisPositions beside{26.5, -120.0, 0.0, 0.0}, too_near{25.5, -120.0, 0.0, 0.0};
  const AxisPositions out_beside{26.5, 0.0, 0.0, 0.0}, before{0.0, -50.0, 0.0, 0.0};
  EXPECT_EQ(verdict(beside, {out_beside, before}), "free");
  EXPECT_NE(verdict(too_near, {{25.5, 0.0, 0.0, 0.0}}).find("the way from where the machine stands"),
            std::string::npos);
  EXPECT_NE(verdict(beside, {before}).find("the probe would touch the part"), std::string::npos);
  EXPECT_NE(verdict(beside, {{26.5, -120.0, 0.0, 1.0}}).find("the table would turn"), std::string::npos);
}

TEST(CheckClearance, TurningLimitIsTheSweptRadiusLessTheClearance) {
  const Scene scene;
  // The beam runs along -y: the ball of 10 mm begins at -10 along it.
  EXPECT_NEAR(turning_limit_mm(scene.geometry, scene.part.model, {}, 1.0), -11.0, 1e-9);
  RigidTransform aside;
  aside.translation_mm = {30.0, 0.0, 0.0};  // it sweeps a radius of 40 mm
  EXPECT_NEAR(turning_limit_mm(scene.geometry, scene.part.model, aside, 1.0), -41.0, 0.1);
}

}  // namespace
}  // namespace trueblade
