// Covers: every key that DESIGN asks for, with its value, read back from the file; numbers that do not exist
// become null; a run without truth, date or cross-check; names that are not UTF-8; a folder that cannot be
// written; the pose error.
#include "inspection/result_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "tests/inspection/example_result.h"
#include "tests/inspection/fixtures.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

Json written_and_read(const InspectionResult& result) {
  const TemporaryFolder folder;
  write_result_json(folder / "result.json", result);
  return Json::parse(bytes_of(folder / "result.json"));
}

TEST(ResultJson, HoldsEveryKeyOfTheDesign) {
  const Json json = written_and_read(example_result());
  EXPECT_EQ(json["schema"], "trueblade-result");
  EXPECT_EQ(json["schema_version"], kResultSchemaVersion);
  EXPECT_EQ(json["units"]["length"], "mm");
  EXPECT_EQ(json["run"]["seed"], 18446744073709551615ULL);
  EXPECT_EQ(json["run"]["program_version"], "1.2.3");

  const Json& view = json["views"][0];
  EXPECT_EQ(view["view"], "front");
  EXPECT_EQ(view["points"], 1500);
  EXPECT_EQ(view["surfaces"], 102);
  EXPECT_EQ(view["facets"], 24000);
  EXPECT_EQ(view["pose"]["rotation_wxyz"], Json({0.5, 0.5, -0.5, 0.5}));
  EXPECT_EQ(view["pose"]["translation_mm"], Json({1.0, -2.0, 3.25}));
  ASSERT_EQ(view["pose_covariance"].size(), 6U);
  ASSERT_EQ(view["pose_covariance"][2].size(), 6U);
  EXPECT_EQ(view["pose_covariance"][2][3], 1.5e-9);
  EXPECT_EQ(view["iterations"], 11);
  EXPECT_EQ(view["termination"], to_string(Termination::converged_rms));
  EXPECT_EQ(view["inliers"], 1490);
  EXPECT_EQ(view["outliers"], 10);
  EXPECT_EQ(view["weighted_rms_mm"], 0.00091);
  EXPECT_EQ(view["rms_mm"], 0.001);
  EXPECT_EQ(view["min_mm"], -0.004);
  EXPECT_EQ(view["max_mm"], 0.0041);
  EXPECT_EQ(view["initial_rms_mm"], 0.222);
  EXPECT_EQ(view["time_s"]["scan"], 12.5);
  EXPECT_EQ(view["time_s"]["register"], 0.02);
  EXPECT_EQ(view["time_s"]["evaluate"], 0.01);
  EXPECT_EQ(view["truth"]["translation_error_mm"], 1e-4);
  EXPECT_EQ(view["truth"]["rotation_error_rad"], 2e-6);
  EXPECT_EQ(view["truth"]["pose"]["translation_mm"], Json({1.0, -2.0, 3.0}));
  EXPECT_EQ(view["deviations"]["outliers"], 7);
  EXPECT_EQ(view["per_surface"][0]["name"], "airfoil");
}

TEST(ResultJson, NumbersThatDoNotExistAreNull) {
  InspectionResult result = example_result();
  ViewResult& view = result.views[0];
  view.statistics = {};
  view.truth.reset();
  view.time = {};
  view.initial_rms_mm = INFINITY;
  result.run.date.clear();
  const Json json = written_and_read(result);
  EXPECT_TRUE(json["views"][0]["rms_mm"].is_null());
  EXPECT_TRUE(json["views"][0]["min_mm"].is_null());
  EXPECT_TRUE(json["views"][0]["initial_rms_mm"].is_null());
  EXPECT_TRUE(json["views"][0]["time_s"]["scan"].is_null());
  EXPECT_TRUE(json["views"][0]["truth"].is_null());
  EXPECT_TRUE(json["views"][0]["cross_check"].is_null());
  EXPECT_TRUE(json["run"]["date"].is_null());
}

TEST(ResultJson, NamesNeedNotBeUtf8) {
  InspectionResult result = example_result();
  result.run.scenario = "blade_\xFF.yaml";
  EXPECT_EQ(written_and_read(result)["run"]["scenario"], "blade_\xEF\xBF\xBD.yaml");
}

TEST(ResultJson, UnwritableFolderIsBadInput) {
  EXPECT_THROW(write_result_json("/proc/nowhere/result.json", example_result()), InputError);
}

TEST(PoseError, IsTheDisplacementOfTheCentroidAndTheAngle) {
  const RigidTransform truth{rotation_from_vector({0.0, 0.0, 0.2}), {5.0, 0.0, 0.0}};
  const Vec3 centroid_mcs(100.0, 0.0, 0.0);
  const Vec3 pivot = truth * centroid_mcs;
  // A step about the centroid: 3-4-0 micrometres and 1e-4 rad; the rotation does not move the centroid.
  Vec6 step;
  step << 0.0, 1e-4, 0.0, 0.003, 0.004, 0.0;
  const PoseError error = pose_error(moved_about(truth, step, pivot), truth, centroid_mcs);
  EXPECT_NEAR(error.translation_error_mm, 0.005, 1e-13);  // roundings of 100 mm: 1.1e-14 mm each
  EXPECT_NEAR(error.rotation_error_rad, 1e-4, 1e-14);
}

}  // namespace
}  // namespace trueblade
