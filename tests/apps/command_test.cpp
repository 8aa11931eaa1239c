// The command as a user runs it: help and version; what an inspection leaves in its folder; that two runs
// agree byte for byte, times apart; that resolved.yaml runs again to the same result; that --json is JSON;
// that a written scan registers to the pose that the inspection found; verdicts and exit codes of regress;
// Ctrl-C.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/apps/sample_inputs.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

Json without_times(Json document) {
  for (auto& element : document.items()) {
    if (element.key() == "time_s" || element.key() == "date")
      element.value() = nullptr;
    else if (element.value().is_structured())
      element.value() = without_times(element.value());
  }
  return document;
}

Json result_of(const std::filesystem::path& folder) {
  return Json::parse(text_of(folder / "result.json"));
}

TEST(Command, HelpAndVersionSucceed) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--help"},
                                             {"inspect", "--help"},
                                             {"scan", "--help"},
                                             {"register", "--help"},
                                             {"part", "--help"},
                                             {"part", "info", "--help"},
                                             {"part", "facet", "--help"},
                                             {"part", "make", "--help"},
                                             {"regress", "--help"},
                                             {"study", "--help"},
                                             {"study", "show", "--help"},
                                             {"study", "merge", "--help"}}) {
    const ChildResult help = run_trueblade(arguments);
    EXPECT_EQ(help.exit_code, 0) << help.err;
    EXPECT_NE(help.out.find("Usage:"), std::string::npos) << help.out;
  }
  const ChildResult version = run_trueblade({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("trueblade 0.", 0), 0u) << version.out;
  EXPECT_NE(version.out.find("commit"), std::string::npos);
}

TEST(Inspect, LeavesAWholeRunFolder) {
  const CubeFolder folder;
  const ChildResult result = run_trueblade({"inspect", "cube.yaml", "--out", "run"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* file :
       {"resolved.yaml", "result.json", "scan_front.ply", "scan_turned.ply", "deviations_front.ply",
        "deviations_turned.ply", "front.exr", "turned.exr", "front.png", "turned.png"})
    EXPECT_GT(std::filesystem::file_size(folder / "run" / file), 100u) << file;
  EXPECT_NE(result.out.find("RMS"), std::string::npos);
  EXPECT_NE(result.out.find("Report: run"), std::string::npos) << result.out;
  // Every file that is named is there.
  std::istringstream lines(result.out.substr(result.out.find("Report: run")));
  std::string line;
  std::getline(lines, line);
  std::size_t named = 0;
  for (; std::getline(lines, line); ++named) {
    const std::string file = line.substr(2, line.find("  ", 2) - 2);
    EXPECT_TRUE(std::filesystem::exists(folder / "run" / file)) << line;
  }
  EXPECT_GE(named, 10u) << result.out;

  const Json document = result_of(folder / "run");
  ASSERT_EQ(document["views"].size(), 2u);
  for (const Json& view : document["views"]) {
    // Sensor noise of 3 um at normal incidence; the faces are seen at 55 degrees, where the signal is
    // cos(55) = 0.57: 3 / 0.57 = 5.3 um along the beam, 5.3 * 0.57 = 3 um along the normal. Over 500 points
    // its relative standard error is 1/sqrt(1000) = 3 %; 20 % covers speckle and six fitted numbers too.
    EXPECT_NEAR(view["rms_mm"].get<double>(), 0.003, 0.0006);
    // Fixture error: 0.2 and 0.3 mm, 0.4 degrees on 10 mm.
    EXPECT_GT(view["initial_rms_mm"].get<double>(), 0.05);
    // Three faces with 200 points each hold the centroid to 0.003 / sqrt(200) = 0.0002 mm; five times that.
    EXPECT_LT(view["truth"]["translation_error_mm"].get<double>(), 0.001);
  }
}

// The range image of a run is read back by the program; what the simulation knows is in it.
TEST(Inspect, RangeImageIsReadBack) {
  const CubeFolder folder;
  const ChildResult run = run_trueblade({"inspect", "cube.yaml", "--out", "run"}, folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // The nominal part stands in the place of the true one: every true deviation is zero.
  const Json truth = result_of(folder / "run")["views"][0]["truth"];
  EXPECT_EQ(truth["true_deviation_rms_mm"], 0.0);
  EXPECT_GT(truth["deviation_error_rms_mm"], 0.0);
  EXPECT_NE(run.err.find("fell out of the working range"), std::string::npos) << run.err;

  const ChildResult result = run_trueblade({"image", "run/front.exr", "--json"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json image = Json::parse(result.out);
  EXPECT_EQ(image["scenario"], "cube");
  EXPECT_EQ(image["seed"], 5);
  std::map<std::string, Json> channels;
  for (const Json& channel : image["channels"]) channels[channel["name"]] = channel;
  EXPECT_EQ(channels.size(), 18u);
  EXPECT_EQ(channels.at("true_deviation")["max"], 0.0);
  // Three faces about the space diagonal, seen along it: 54.7 degrees, and less where a point lies at an
  // edge.
  EXPECT_LT(channels.at("incidence")["min"], 0.98);
  EXPECT_GT(channels.at("incidence")["max"], 0.93);
  EXPECT_LT(channels.at("incidence")["max"], 0.98);
  EXPECT_EQ(channels.at("mask")["max"], 1.0);
}

TEST(Inspect, TwoRunsAgreeByteForByteTimesApart) {
  const CubeFolder folder;
  for (const char* out : {"first", "second"})
    ASSERT_EQ(run_trueblade({"inspect", "cube.yaml", "--out", out}, folder.path()).exit_code, 0);
  for (const char* file : {"resolved.yaml", "scan_front.ply", "deviations_turned.ply"})
    EXPECT_EQ(text_of(folder / "first" / file), text_of(folder / "second" / file)) << file;
  EXPECT_EQ(without_times(result_of(folder / "first")).dump(),
            without_times(result_of(folder / "second")).dump());
}

TEST(Inspect, TheSeedChangesTheNoise) {
  const CubeFolder folder;
  for (const char* seed : {"1", "2"})
    ASSERT_EQ(run_trueblade({"inspect", "cube.yaml", "--out", seed, "--seed", seed}, folder.path()).exit_code,
              0);
  EXPECT_NE(text_of(folder / "1/scan_front.ply"), text_of(folder / "2/scan_front.ply"));
}

TEST(Inspect, ResolvedScenarioRunsAgainToTheSameResult) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"inspect", "cube.yaml", "--out", "run", "--seed", "9"}, folder.path()).exit_code,
            0);
  const ChildResult again = run_trueblade({"inspect", "run/resolved.yaml", "--out", "again"}, folder.path());
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(text_of(folder / "again/resolved.yaml"), text_of(folder / "run/resolved.yaml"));
  EXPECT_EQ(without_times(result_of(folder / "again")).dump(),
            without_times(result_of(folder / "run")).dump());
}

TEST(Inspect, AToleranceThatIsLeftEndsWithExitCode1) {
  const CubeFolder folder;
  folder.write("tight.yaml", std::string(kCubeScenario) + "inspection: {tolerance_mm: [-0.001, 0.001]}\n");
  const ChildResult result = run_trueblade({"inspect", "tight.yaml", "--out", "run"}, folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("tolerance"), std::string::npos) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "run/result.json"));
}

TEST(Json, StandardOutputIsOneDocument) {
  const CubeFolder folder;
  folder.write("promise.yaml", std::string(kCubeScenario) + "expect: {front: {rms_mm: [0, 1]}}\n");
  const Json info =
      Json::parse(run_trueblade({"part", "info", "cube.obj", "--unit", "cm", "--json"}, folder.path()).out);
  EXPECT_EQ(info["facets"], 12);
  EXPECT_EQ(info["nodes"], 8);
  EXPECT_EQ(info["closed"], true);
  EXPECT_EQ(info["area_mm2"], 600.0);
  EXPECT_EQ(info["volume_mm3"], 1000.0);
  const Json run =
      Json::parse(run_trueblade({"inspect", "cube.yaml", "--out", "run", "--json"}, folder.path()).out);
  EXPECT_EQ(run.dump(), result_of(folder / "run").dump());
  const Json files =
      Json::parse(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply", "--json"}, folder.path()).out);
  EXPECT_EQ(files.size(), 2u);
  const Json verdicts = Json::parse(run_trueblade({"regress", "promise.yaml", "--json"}, folder.path()).out);
  EXPECT_EQ(verdicts[0]["passed"], true);
}

TEST(Register, AWrittenScanFindsThePoseOfTheInspection) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"inspect", "cube.yaml", "--out", "run"}, folder.path()).exit_code, 0);
  ASSERT_EQ(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  EXPECT_EQ(text_of(folder / "scan_front.ply"), text_of(folder / "run/scan_front.ply"));
  const ChildResult result =
      run_trueblade({"register", "--part", "cube.obj", "--unit", "cm", "--scan", "scan_front.ply",
                     "--initial", "scan_front.pose.yaml", "--json", "--out", "report"},
                    folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json inspected = result_of(folder / "run")["views"][0],
             registered = Json::parse(result.out)["views"][0];
  // The same points, part, options and initial pose, to the last bit.
  EXPECT_EQ(registered["pose"].dump(), inspected["pose"].dump());
  // The form of the part is known to the inspection alone.
  for (const char* key : {"pose", "translation_error_mm", "rotation_error_rad"})
    EXPECT_EQ(registered["truth"][key].dump(), inspected["truth"][key].dump()) << key;
  EXPECT_TRUE(std::filesystem::exists(folder / "report/result.json"));
  EXPECT_TRUE(std::filesystem::exists(folder / "report/deviations_scan.ply"));
}

// One row for every variant; the pose errors come from the true pose that the scan's pose file knows.
TEST(Register, ComparesAllVariantsOnOneScan) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  std::vector<std::string> arguments{"register",       "--part",    "cube.obj",
                                     "--unit",         "cm",        "--scan",
                                     "scan_front.ply", "--initial", "scan_front.pose.yaml",
                                     "--compare"};
  const ChildResult table = run_trueblade(arguments, folder.path());
  ASSERT_EQ(table.exit_code, 0) << table.err;
  EXPECT_EQ(table.out.find("| variant"), 0u);
  arguments.push_back("--json");
  const Json rows = Json::parse(run_trueblade(arguments, folder.path()).out);
  std::size_t table_lines = 0;
  std::string line, heading, notes;
  for (std::istringstream lines(table.out); std::getline(lines, line);) {
    if (!line.starts_with("|")) notes += line + '\n';
    if (line.starts_with("|") && table_lines++ == 0) heading = line;
  }
  EXPECT_EQ(table_lines, rows.size() + 2);
  for (const char* column : {"stopped by", "closest points", "facets per query", "from cache", "time ms",
                             "inliers", "RMS um", "centroid error", "rotation error"}) {
    EXPECT_NE(heading.find(column), std::string::npos) << column;
    EXPECT_NE(notes.find(column), std::string::npos) << column;
  }
  const auto row = [&](std::string_view name) {
    return *std::find_if(rows.begin(), rows.end(), [&](const Json& r) { return r["variant"] == name; });
  };
  // As in Inspect.LeavesAWholeRunFolder: the centroid is held to 0.0002 mm; five times that.
  for (const char* name : {"zhu2007", "zhu2007, Anderson", "zhu2007, rejection worst_fraction", "default"})
    EXPECT_LT(row(name)["translation_error_mm"].get<double>(), 0.001) << name;
  EXPECT_EQ(row("zhu2007, no cache")["cache_hits"], 0);
  EXPECT_GT(row("zhu2007")["cache_hits"], 0);

  const ChildResult both = run_trueblade(
      {"register", "--part", "cube.obj", "--scan", "scan_front.ply", "--compare", "--preset", "zhu2007"},
      folder.path());
  EXPECT_EQ(both.exit_code, 2);
}

TEST(Part, FacetsAndMakesFilesThatItReadsBack) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"part", "facet", "cube.obj", "--unit", "cm", "--out", "cube.ply"}, folder.path())
                .exit_code,
            0);
  const ChildResult info =
      run_trueblade({"part", "info", "cube.ply", "--unit", "mm", "--json"}, folder.path());
  EXPECT_EQ(Json::parse(info.out)["volume_mm3"], 1000.0);

  folder.write("small.yaml", "spanwise_patches: 2\n");
  const ChildResult made = run_trueblade(
      {"part", "make", "turbine_blade", "--parameters", "small.yaml", "--out", "blade.step"}, folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const ChildResult blade = run_trueblade({"part", "info", "blade.step", "--json"}, folder.path());
  ASSERT_EQ(blade.exit_code, 0) << blade.err;
  EXPECT_EQ(Json::parse(blade.out)["closed"], true);
}

TEST(Part, AFullDiskIsNamedAsTheReason) {
  const ScratchFolder folder;
  const ChildResult made = run_trueblade({"part", "make", "formed_part", "--out", "formed.step"},
                                         folder.path(), {.largest_file_bytes = 100'000});
  EXPECT_EQ(made.exit_code, 2) << made.ended_by;
  EXPECT_NE(made.err.find("formed.step: cannot be written: File too large"), std::string::npos) << made.err;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Regress, HoldsScenariosToTheirExpectations) {
  const CubeFolder folder;
  folder.write("holds.yaml",
               std::string(kCubeScenario) + "expect: {front: {rms_mm: [0.001, 0.005], points: [1, 1e6]}}\n");
  folder.write("fails.yaml", std::string(kCubeScenario) + "expect: {turned: {rms_mm: [0.1, 0.2]}}\n");

  const ChildResult holds = run_trueblade({"regress", "holds.yaml"}, folder.path());
  EXPECT_EQ(holds.exit_code, 0) << holds.out;
  EXPECT_NE(holds.out.find("1 passed, 0 failed"), std::string::npos) << holds.out;

  const ChildResult fails =
      run_trueblade({"regress", "holds.yaml", "fails.yaml", "--junit", "junit.xml"}, folder.path());
  EXPECT_EQ(fails.exit_code, 1);
  EXPECT_NE(fails.out.find("1 passed, 1 failed"), std::string::npos) << fails.out;
  const std::string xml = text_of(folder / "junit.xml");
  EXPECT_NE(xml.find("<testsuite name=\"holds\" tests=\"2\" failures=\"0\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("<testsuite name=\"fails\" tests=\"1\" failures=\"1\""), std::string::npos) << xml;
}

TEST(Regress, AScenarioThatDoesNotRunFailsAndTheOthersStillRun) {
  const CubeFolder folder;
  folder.write(
      "broken.yaml",
      "part: {file: none.stl, unit: mm}\nscan: {views: [{name: a}]}\nexpect: {a: {rms_mm: [0, 1]}}\n");
  folder.write("holds.yaml", std::string(kCubeScenario) + "expect: {front: {converged: [1, 1]}}\n");
  const ChildResult result = run_trueblade({"regress", "broken.yaml", "holds.yaml"}, folder.path());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("none.stl: no such file"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("1 passed, 1 failed"), std::string::npos) << result.out;
}

TEST(Regress, AScenarioWhoseMachineIsNotThereFailsAndTheOthersStillRun) {
  const CubeFolder folder;
  std::string text = kCubeScenario;
  // Nothing listens on port 1.
  text.replace(
      text.find("machine:\n"), 9,
      "machine:\n  backend: linuxcnc\n  controller: {host: 127.0.0.1, command_port: 1, sample_port: 2}\n");
  folder.write("absent.yaml", text + "expect: {front: {converged: [1, 1]}}\n");
  folder.write("holds.yaml", std::string(kCubeScenario) + "expect: {front: {converged: [1, 1]}}\n");
  const ChildResult result = run_trueblade({"regress", "absent.yaml", "holds.yaml"}, folder.path());
  EXPECT_EQ(result.exit_code, 1) << result.ended_by;
  EXPECT_NE(result.out.find("127.0.0.1:"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("1 passed, 1 failed"), std::string::npos) << result.out;
}

// The cube of the scenario stands on a corner, three faces towards the probe: whatever is chosen, a face
// turned away from the beam at all angles cannot be seen, and the views that are chosen see no less than the
// stated ones.
TEST(Plan, TellsAndDrawsCoverage) {
  const CubeFolder folder;
  const ChildResult result = run_trueblade({"plan", "cube.yaml", "--json", "--out", "run"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json plan = Json::parse(result.out);
  EXPECT_GT(plan["seen"], 0.4);
  ASSERT_EQ(plan["views"].size(), 2u);
  EXPECT_GT(plan["views"][0]["points"], 100);
  EXPECT_GT(plan["views"][0]["time_s"], 0.0);
  double shares = 0.0;
  for (const Json& share : plan["surfaces"][0]["share"]) shares += share.get<double>();
  EXPECT_NEAR(shares, 1.0, 1e-12);
  for (const char* picture : {"run/coverage.svg", "run/coverage.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / picture)) << picture;

  const ChildResult automatic =
      run_trueblade({"plan", "cube.yaml", "--automatic", "--json", "--out", "run"}, folder.path());
  ASSERT_EQ(automatic.exit_code, 0) << automatic.err;
  EXPECT_GE(Json::parse(automatic.out)["seen"], plan["seen"]);
}

TEST(Plan, AnglesOfTheCommandLineOverrideTheScenario) {
  const CubeFolder folder;
  const ChildResult result = run_trueblade(
      {"plan", "cube.yaml", "--theta-deg", "0", "120", "240", "--json", "--out", "run"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json plan = Json::parse(result.out);
  ASSERT_EQ(plan["views"].size(), 3u);
  EXPECT_EQ(plan["views"][1]["view"], "theta_120");
}

// A scan whose views are chosen measures the planned points.
TEST(Plan, ChosenViewsAreMeasured) {
  const CubeFolder folder;
  std::string text = kCubeScenario;
  const std::string views = "views: [{name: front}, {name: turned, theta_deg: 20}]";
  text.replace(text.find(views), views.size(), "automatic_views: {most_views: 2, candidate_step_deg: 60}");
  folder.write("automatic.yaml", text);
  const ChildResult plan = run_trueblade({"plan", "automatic.yaml", "--json", "--out", "run"}, folder.path());
  const ChildResult scan =
      run_trueblade({"scan", "automatic.yaml", "--json", "--out", "s.ply"}, folder.path());
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  ASSERT_EQ(scan.exit_code, 0) << scan.err;
  const Json planned = Json::parse(plan.out)["views"], scanned = Json::parse(scan.out);
  ASSERT_EQ(planned.size(), 2u);
  ASSERT_EQ(scanned.size(), 2u);
  for (std::size_t v = 0; v < 2; ++v) {
    EXPECT_EQ(scanned[v]["view"], planned[v]["view"]);
    EXPECT_EQ(scanned[v]["planned"], planned[v]["points"]);
  }
}

TEST(Interrupt, KeepsWhatWasMeasured) {
  const CubeFolder folder;
  // A raster fine enough that the first report of progress comes long before the end.
  std::string fine = kCubeScenario;
  fine.replace(fine.find("spacing_mm: 0.5"), 15, "spacing_mm: 0.02");
  folder.write("fine.yaml", fine);
  const ChildResult result = run_trueblade({"inspect", "fine.yaml", "--out", "run"}, folder.path(),
                                           {.interrupt_after = "scan front: "});
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "run/scan_front.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run/scan_turned.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run/result.json"));
  // No table without rows, and no file is promised that is not there.
  EXPECT_EQ(result.out.find("RMS mm"), std::string::npos) << result.out;
  for (const char* file : {"front.png", "front.exr", "report.html", "result.json", "statistics.csv"})
    EXPECT_EQ(result.out.find(file), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("No view was finished"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("--resume"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace trueblade
