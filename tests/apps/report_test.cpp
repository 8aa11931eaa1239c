// The report of a run: result.json keeps its schema; the page opens in headless Chromium without a console
// error, shows a picture that is not empty, lets a point be picked and colours the surface; `report` makes
// the same files again and says what a folder lacks; `compare` tells what changed; views and features that
// fail leave the rest of the report; one view that is left is judged from the datum. Tests that need Chromium
// or python3-jsonschema are skipped where these are absent.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/run_folder.h"
#include "tests/apps/browser.h"
#include "tests/apps/sample_inputs.h"

namespace trueblade {
namespace {

using Json = nlohmann::json;

// Profiles, groups and a section (45 degrees wide in the cube's own frame there is a square to cut).
constexpr const char* kInspection = R"(inspection:
  tolerance_mm: [-0.05, 0.05]
  profiles:
    - {name: all, tolerance_mm: [-0.05, 0.05]}
    - {name: unknown, surfaces: ["7"], tolerance_mm: [-0.05, 0.05]}
  sections: {heights_mm: [5, 50], half_width_mm: 0.5}
)";

class ReportTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("full.yaml", std::string(kCubeScenario) + kInspection);
    inspected_ = run_trueblade({"inspect", "full.yaml", "--out", "run"}, folder_.path());
  }
  Json result() const { return Json::parse(text_of(folder_ / "run/result.json")); }

  CubeFolder folder_;
  ChildResult inspected_;
};

TEST_F(ReportTest, WhatIsMissingIsNamedAndTheRestIsMade) {
  EXPECT_EQ(inspected_.exit_code, 2);
  EXPECT_NE(inspected_.err.find("profile unknown: surface \"7\" does not exist"), std::string::npos)
      << inspected_.err;
  EXPECT_NE(inspected_.err.find("section at 50 mm"), std::string::npos) << inspected_.err;
  const Json document = result();
  EXPECT_EQ(document["missing"].size(), 2u);
  ASSERT_EQ(document["profiles"].size(), 1u);
  EXPECT_EQ(document["profiles"][0]["conformity"], "conforming");
  EXPECT_GT(document["joint"]["inliers"].get<int>(), 100);
  EXPECT_EQ(document["sections"].size(), 2u);
  const std::string html = text_of(folder_ / "run/report.html");
  EXPECT_NE(html.find("section at 50 mm"), std::string::npos);
  EXPECT_EQ(html.find("src=\""), std::string::npos);  // nothing is fetched
  EXPECT_NE(text_of(folder_ / "run/statistics.csv").find("\"turned\""), std::string::npos);
}

TEST_F(ReportTest, TheResultKeepsItsSchema) {
  if (!succeeds("python3 -c 'import jsonschema'")) GTEST_SKIP() << "python3-jsonschema is not installed";
  const std::string check =
      "python3 -c \"import json, jsonschema, sys; jsonschema.validate(json.load(open(sys.argv[1])), "
      "json.load(open(sys.argv[2])))\" ";
  const std::string schema = std::string(" ") + TRUEBLADE_SOURCE_DIR + "/docs/result.schema.json";
  EXPECT_TRUE(succeeds(check + (folder_ / "run/result.json").string() + schema));
  Json broken = result();
  broken["views"][0].erase("rms_mm");
  EXPECT_FALSE(succeeds(check + folder_.write("broken.json", broken.dump()).string() + schema));
}

TEST_F(ReportTest, OpensInARealBrowser) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  const Json found = self_test(folder_, "run/report.html");
  ASSERT_TRUE(found.is_object());
  EXPECT_TRUE(found["errors"].empty()) << found;
  ASSERT_TRUE(found["webgl"].get<bool>()) << found;
  EXPECT_GT(found["points"].get<int>(), 500);
  // The cube fills a good part of the picture; grey part and coloured points make many colours.
  EXPECT_GT(found["painted"].get<double>(), 0.05 * found["pixels"].get<double>()) << found;
  EXPECT_GT(found["colours"].get<int>(), 20) << found;
  EXPECT_NE(found["picked"].get<std::string>().find("view front, point"), std::string::npos) << found;
  EXPECT_GT(found["surface_differs"].get<int>(), 1000) << found;
  // Two views of one cube: nearly every deviation is another at the pose of both, none by much.
  EXPECT_GT(found["pose_differs"].get<int>(), 500) << found;
  EXPECT_GT(found["pose_moves_mm"].get<double>(), 0.0) << found;
  EXPECT_LT(found["pose_moves_mm"].get<double>(), 0.02) << found;
  // Of two views and of both together; the diagonals of the correlations.
  EXPECT_EQ(found["covariances"].get<int>(), 3) << found;
  EXPECT_EQ(found["correlations_of_one"].get<int>(), 3 * 6) << found;
}

TEST_F(ReportTest, IsMadeAgainFromTheFolder) {
  const std::string first = text_of(folder_ / "run/report.html");
  std::filesystem::remove(folder_ / "run/report.html");
  const ChildResult again = run_trueblade({"report", "run"}, folder_.path());
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(text_of(folder_ / "run/report.html"), first);

  std::filesystem::remove(folder_ / "run/deviations_front.ply");
  std::filesystem::remove(folder_ / "run/resolved.yaml");
  const ChildResult partly = run_trueblade({"report", "run"}, folder_.path());
  EXPECT_EQ(partly.exit_code, 2);
  EXPECT_NE(partly.err.find("deviations_front.ply"), std::string::npos) << partly.err;
  EXPECT_NE(text_of(folder_ / "run/report.html").find("deviations_front.ply: no such file"),
            std::string::npos);
}

TEST_F(ReportTest, AFolderThatItCannotReadIsRefused) {
  EXPECT_NE(
      run_trueblade({"report", "nowhere"}, folder_.path()).err.find("nowhere/result.json: no such file"),
      std::string::npos);
  Json newer = result();
  newer["schema_version"] = 99;
  folder_.write("run/result.json", newer.dump());
  const ChildResult refused = run_trueblade({"report", "run"}, folder_.path());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("written by a newer trueblade"), std::string::npos) << refused.err;
  for (const char* text :
       {"", "[1, 2]", "{\"schema\": 7}", "{\"schema\": \"trueblade-result\", \"schema_version\": 1}"}) {
    folder_.write("run/result.json", text);
    EXPECT_EQ(run_trueblade({"report", "run"}, folder_.path()).exit_code, 2) << text;
  }
}

TEST_F(ReportTest, CompareTellsWhatChanged) {
  ASSERT_EQ(
      run_trueblade({"inspect", "full.yaml", "--out", "other", "--seed", "6"}, folder_.path()).exit_code, 2);
  const ChildResult same = run_trueblade({"compare", "run", "run"}, folder_.path());
  EXPECT_EQ(same.exit_code, 0) << same.err;
  // The heading and the count, and nothing between them.
  const std::string last = same.out.substr(same.out.rfind('\n', same.out.size() - 2) + 1);
  const std::size_t of = last.find(" of ");
  ASSERT_NE(of, std::string::npos) << same.out;
  EXPECT_EQ(last.substr(0, of), last.substr(of + 4, of)) << same.out;
  EXPECT_EQ(std::count(same.out.begin(), same.out.end(), '\n'), 2) << same.out;
  const ChildResult changed = run_trueblade({"compare", "run", "other"}, folder_.path());
  EXPECT_EQ(changed.exit_code, 0) << changed.err;
  EXPECT_NE(changed.out.find("seed: 5 in the first run, 6 in the second"), std::string::npos) << changed.out;
  const Json json = Json::parse(run_trueblade({"compare", "run", "other", "--json"}, folder_.path()).out);
  bool found = false;
  for (const Json& change : json["changes"])
    if (change["what"] == "view front" && change["name"] == "rms_mm") {
      found = true;
      EXPECT_NEAR(change["difference"].get<double>(),
                  change["after"].get<double>() - change["before"].get<double>(), 1e-15);
    }
  EXPECT_TRUE(found);

  // The other seed turns and shifts nothing of the part but the pose that is found: by the definition of the
  // pivot.
  const Json a = result()["views"][0];
  const Json b = Json::parse(text_of(folder_ / "other/result.json"))["views"][0];
  const auto vector = [](const Json& list) {
    return Vec3(list[0].get<double>(), list[1].get<double>(), list[2].get<double>());
  };
  const Vec3 pivot = vector(a["pose_covariance_pivot_mm"]);
  const Vec3 moved = pose_of(b["pose"]) * (pose_of(a["pose"]).inverse() * pivot) - pivot;
  int components = 0;
  for (const Json& change : json["changes"])
    for (const int k : {0, 1, 2})
      if (change["what"] == "view front" && change["name"] == std::string("pose, centroid ") + "xyz"[k]) {
        ++components;
        EXPECT_NEAR(change["difference"].get<double>(), moved[k], 1e-12);
        EXPECT_GT(change["standard_uncertainty"].get<double>(), 0.0);
      }
  EXPECT_EQ(components, 3);
}

TEST(FailedView, LeavesTheOthers) {
  const CubeFolder folder;
  // A fixture error of 100 mm takes the cube out of the lens's range and of the planned lines.
  std::string lost = kCubeScenario;
  lost.replace(lost.find("fixture_y: {mean_mm: -0.3}"), 26, "fixture_y: {mean_mm: -60, scope: view}");
  folder.write("lost.yaml", lost + "expect: {front: {fails: \"none of\"}, turned: {fails: \"none of\"}}\n");
  const ChildResult result = run_trueblade({"inspect", "lost.yaml", "--out", "run"}, folder.path());
  EXPECT_EQ(result.exit_code, 2) << result.err;
  const Json document = Json::parse(text_of(folder / "run/result.json"));
  EXPECT_EQ(document["views"][0]["termination"], "not registered");
  EXPECT_TRUE(document["views"][0]["rms_mm"].is_null());
  EXPECT_TRUE(std::filesystem::exists(folder / "run/report.html"));
  const ChildResult regress = run_trueblade({"regress", "lost.yaml"}, folder.path());
  EXPECT_EQ(regress.exit_code, 0) << regress.out << regress.err;
}

// Every face of the cube, two facets, is a surface of its own.
std::string cube_of_six_surfaces() {
  std::string obj = kCubeObj;
  std::size_t at = 0, facet = 0;
  while ((at = obj.find("f ", at)) != std::string::npos) {
    const std::string group = facet % 2 == 0 ? "g face" + std::to_string(facet / 2) + "\n" : "";
    obj.insert(at, group);
    at += group.size() + 2;
    ++facet;
  }
  return obj;
}

// The first view sees the faces 1, 3 and 4, which are chosen; from behind none of them is seen.
TEST(FailedView, MayBeOneThatSeesNothingOfTheChosenSurfaces) {
  const CubeFolder folder;
  const std::string views = "views: [{name: front}, {name: turned, theta_deg: 20}]";
  std::string hidden = kCubeScenario;
  hidden.replace(hidden.find(views), views.size(),
                 "views: [{name: front}, {name: behind, theta_deg: 180}, {name: turned, theta_deg: 20}]\n"
                 "  surfaces: [1, 3, 4]");
  hidden.replace(hidden.find("cube.obj"), 8, "six.obj");
  folder.write("six.obj", cube_of_six_surfaces());
  folder.write("hidden.yaml", hidden + "expect: {behind: {fails: \"nothing of the chosen surfaces\"}}\n");
  const ChildResult result = run_trueblade({"inspect", "hidden.yaml", "--out", "run"}, folder.path());
  EXPECT_EQ(result.exit_code, 2) << result.err;
  const Json views_of_run = Json::parse(text_of(folder / "run/result.json"))["views"];
  ASSERT_EQ(views_of_run.size(), 3U);
  EXPECT_TRUE(views_of_run[0]["failure"].is_null());
  EXPECT_NE(views_of_run[1]["failure"].get<std::string>().find("nothing of the chosen"), std::string::npos);
  EXPECT_EQ(views_of_run[1]["samples"]["planned"], 0);
  EXPECT_TRUE(views_of_run[2]["failure"].is_null());
  EXPECT_EQ(run_trueblade({"regress", "hidden.yaml"}, folder.path()).exit_code, 0);
  const ChildResult planned = run_trueblade({"plan", "hidden.yaml", "--out", "plan"}, folder.path());
  EXPECT_EQ(planned.exit_code, 0);
  EXPECT_NE(planned.err.find("view behind: nothing of the chosen"), std::string::npos) << planned.err;

  hidden.replace(hidden.find("{name: front}, "), 15, "");
  hidden.replace(hidden.find(", {name: turned, theta_deg: 20}"), 31, ", {name: beside, theta_deg: 190}");
  folder.write("blind.yaml", hidden);
  const ChildResult blind = run_trueblade({"inspect", "blind.yaml", "--out", "none"}, folder.path());
  EXPECT_EQ(blind.exit_code, 2);
  EXPECT_NE(blind.err.find("view beside: nothing of the chosen"), std::string::npos) << blind.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

TEST(Datum, SurfacesThatThePartHasNotAreNoticedBeforeTheScan) {
  const CubeFolder folder;
  folder.write("datum.yaml", std::string(kCubeScenario) + "inspection: {datum_surfaces: [shroud*]}\n");
  const ChildResult result = run_trueblade({"inspect", "datum.yaml", "--out", "run"}, folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("datum_surfaces: surface \"shroud*\" does not exist"), std::string::npos)
      << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

// A range of 2 mm and a fixture that moves between the views: with seed 6 the first view is 0.4 mm off, the
// second sees nothing.
TEST(FailedView, IsLackedByAViewThatIsReported) {
  const CubeFolder folder;
  std::string lost = kCubeScenario;
  lost.replace(lost.find("fixture_y: {mean_mm: -0.3}"), 26, "fixture_y: {sigma_mm: 1.5, scope: view}");
  lost.replace(lost.find("working_range_mm: 70"), 20, "working_range_mm: 2");
  folder.write("lost.yaml", lost);
  const ChildResult result =
      run_trueblade({"inspect", "lost.yaml", "--seed", "6", "--out", "run"}, folder.path());
  EXPECT_EQ(result.exit_code, 2) << result.err;
  const Json views = Json::parse(text_of(folder / "run/result.json"))["views"];
  EXPECT_TRUE(views[0]["converged"].get<bool>());
  EXPECT_LT(views[0]["rms_mm"].get<double>(), 0.004);  // 3 um of noise
  EXPECT_NE(views[1]["failure"].get<std::string>().find("none of"), std::string::npos);
  for (const char* file : {"front.png", "deviations_front.ply", "report.html", "statistics.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder / "run" / file)) << file;

  // The view keeps its best fit; the part is judged from the datum, one face, which leaves three freedoms
  // open.
  lost.replace(lost.find("cube.obj"), 8, "six.obj");
  folder.write("six.obj", cube_of_six_surfaces());
  folder.write("datum.yaml", lost + "inspection: {datum_surfaces: [\"1\"]}\n");
  run_trueblade({"inspect", "datum.yaml", "--seed", "6", "--out", "datum"}, folder.path());
  const Json document = Json::parse(text_of(folder / "datum/result.json"));
  EXPECT_EQ(document["views"][0]["undetermined"].size(), 0u);
  ASSERT_TRUE(document["joint"].is_object()) << document["missing"];
  EXPECT_EQ(document["joint"]["undetermined"].size(), 3u);
  ASSERT_EQ(document["joint"]["views"].size(), 1u);
  EXPECT_EQ(document["joint"]["views"][0]["view"], "front");
}

// Of the blade at this spacing, with this seed, a point at the border of the airfoil comes with one pose and
// goes with the next.
TEST(Groups, APointAtTheBorderDoesNotLeadTheFitRoundInACircle) {
  const CubeFolder folder;
  std::string text = text_of(std::filesystem::path(TRUEBLADE_SOURCE_DIR) / "scenarios/blade_inspection.yaml");
  const std::size_t spacing = text.find("spacing_mm: 0.3"), sections = text.find("  sections:");
  ASSERT_NE(spacing, std::string::npos);
  ASSERT_NE(sections, std::string::npos);
  text.erase(sections, text.find('\n', sections) + 1 - sections);
  text.replace(spacing, 15, "spacing_mm: 0.6");
  text.erase(text.find("expect_part:"));
  folder.write("blade.yaml", text);
  run_trueblade({"inspect", "blade.yaml", "--seed", "6", "--out", "run"}, folder.path());
  const Json document = Json::parse(text_of(folder / "run/result.json"));
  EXPECT_TRUE(document["missing"].empty()) << document["missing"];
  EXPECT_EQ(document["offsets"].size(), 1u);
}

}  // namespace
}  // namespace trueblade
