// Studies as a user runs them: the same rows for any number of threads, for interrupted and resumed, merged
// and MPI runs; one trial shown alone; what the statement says; bad input.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/apps/browser.h"
#include "tests/apps/sample_inputs.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStudy = R"(scenario: cube.yaml
seed: 3
trials: 40
coverage_probability: 0.9
set:
  - {field: scan.spacing_mm, value: 2.0}
  - {field: "machine.simulation.errors.fixture_x", value: "{sigma_mm: 0.1}"}
cases:
  - {name: weighted}
  - {name: uniform, set: [{field: registration.weights.source, value: uniform}]}
headline: error_translation_x_mm
)";

class StudyTest : public ::testing::Test {
 protected:
  StudyTest() { write("study.yaml", kStudy); }

  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  ChildResult run(std::vector<std::string> arguments, const ChildOptions& options = {}) const {
    arguments.insert(arguments.begin(), "study");
    return run_trueblade(arguments, folder_.path(), options);
  }
  Json document(const std::string& out) const { return Json::parse(text_of(folder_ / out / "study.json")); }
  std::string rows(const std::string& out) const { return document(out)["rows_hash"]; }
  // A number of trials.csv, in the row that begins so.
  double cell(const std::string& out, const std::string& row, const std::string& name) const {
    std::ifstream csv(folder_ / out / "trials.csv");
    std::string head, line;
    std::getline(csv, head);
    while (std::getline(csv, line) && line.rfind(row, 0) != 0) {
    }
    std::istringstream names(head), cells(line);
    std::string key, value;
    while (std::getline(names, key, ',') && std::getline(cells, value, ','))
      if (key == name) return std::stod(value);
    return std::nan("");
  }

  CubeFolder folder_;
};

TEST_F(StudyTest, SameRowsForThreadsRangesAndInterruption) {
  ASSERT_EQ(run({"study.yaml", "--threads", "1", "--out", "one"}).exit_code, 0);
  const std::string hash = rows("one");
  ASSERT_EQ(run({"study.yaml", "--threads", "3", "--out", "three"}).exit_code, 0);
  EXPECT_EQ(rows("three"), hash);
  // The whole statement, not only the rows.
  EXPECT_EQ(text_of(folder_ / "one/study.json"), text_of(folder_ / "three/study.json"));

  ASSERT_EQ(run({"study.yaml", "--trials", "25:40", "--out", "b"}).exit_code, 0);
  ASSERT_EQ(run({"study.yaml", "--trials", "25", "--out", "a"}).exit_code, 0);
  const ChildResult merged =
      run({"merge", "study.yaml", "b/trials.sqlite", "a/trials.sqlite", "--out", "merged"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(rows("merged"), hash);

  // A run that ended early, and went on.
  ASSERT_EQ(run({"study.yaml", "--trials", "7", "--out", "early"}).exit_code, 0);
  const ChildResult again = run({"study.yaml", "--out", "early"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("--resume"), std::string::npos) << again.err;
  ASSERT_EQ(run({"study.yaml", "--out", "early", "--resume"}).exit_code, 0);
  EXPECT_EQ(rows("early"), hash);
  EXPECT_EQ(text_of(folder_ / "early/study.json"), text_of(folder_ / "one/study.json"));
}

TEST_F(StudyTest, CtrlCLeavesAStateThatGoesOn) {
  ChildOptions options;
  options.interrupt_after = "trials to do";
  const ChildResult interrupted = run({"study.yaml", "--trials", "3000", "--out", "run"}, options);
  EXPECT_EQ(interrupted.exit_code, 130) << interrupted.err;
  EXPECT_NE(interrupted.err.find("--resume"), std::string::npos) << interrupted.err;
  ASSERT_EQ(run({"study.yaml", "--trials", "20", "--out", "run", "--resume"}).exit_code, 0);
  ASSERT_EQ(run({"study.yaml", "--trials", "20", "--out", "whole"}).exit_code, 0);
  EXPECT_EQ(rows("run"), rows("whole"));
}

// What was finished before a run is kept whatever ends it, and the statement is that of a run without an end.
class EndedStudyTest : public StudyTest {
 protected:
  static constexpr int kBefore = 100, kWhole = 300;

  EndedStudyTest() {
    EXPECT_EQ(run({"study.yaml", "--trials", "300", "--out", "whole"}).exit_code, 0);
    EXPECT_EQ(run({"study.yaml", "--trials", "100", "--out", "run"}).exit_code, 0);
  }
  std::uintmax_t stored_bytes() const { return std::filesystem::file_size(folder_ / "run/trials.sqlite"); }

  void expect_that_it_goes_on() const {
    const ChildResult resumed = run({"study.yaml", "--trials", "300", "--out", "run", "--resume"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    const std::string before_count = "trueblade: study: ";
    const int to_do = std::atoi(resumed.err.c_str() + resumed.err.find(before_count) + before_count.size());
    EXPECT_LE(to_do, kWhole - kBefore) << resumed.err;
    EXPECT_EQ(text_of(folder_ / "run/study.json"), text_of(folder_ / "whole/study.json"));
  }
};

TEST_F(EndedStudyTest, AKillLeavesAStateThatGoesOnToTheSameStatement) {
  const std::uintmax_t before = stored_bytes();
  ChildOptions options;
  options.kill_when = [&] { return stored_bytes() > before; };  // a transaction is being written, or just was
  const ChildResult killed = run({"study.yaml", "--trials", "100000", "--out", "run", "--resume"}, options);
  EXPECT_EQ(killed.ended_by, "signal 9") << killed.err;
  expect_that_it_goes_on();
}

TEST_F(EndedStudyTest, AFullDiskLosesTheBlockInFlightAndSaysWhy) {
  ChildOptions options;
  options.largest_file_bytes = stored_bytes() + 50'000;  // 40 trials
  const ChildResult full = run({"study.yaml", "--trials", "100000", "--out", "run", "--resume"}, options);
  EXPECT_EQ(full.exit_code, 2) << full.ended_by;
  EXPECT_NE(full.err.find("run/trials.sqlite: cannot be written (a quota, a limit of the file size"),
            std::string::npos)
      << full.err;
  EXPECT_NE(full.err.find("what was finished before is kept"), std::string::npos) << full.err;
  expect_that_it_goes_on();
}

class RanksTest : public StudyTest {
 protected:
  void SetUp() override {
    if (std::system("command -v mpirun > /dev/null") != 0) GTEST_SKIP() << "there is no mpirun here";
    if (run_ranks("study.yaml --trials 1 --out probe") != 0 &&
        said().find("built without MPI") != std::string::npos)
      GTEST_SKIP() << "built without MPI";
  }
  // The exit code of mpirun; 124 when it took too long.
  int run_ranks(const std::string& arguments, int limit_s = 100) const {
    const std::string ranks = fmt::format(
        "cd '{}' && OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout {} mpirun "
        // OpenMPI unloads the code of its own caches: a leak detector cannot name whose they were.
        "-x ASAN_OPTIONS=detect_leaks=0 -n 2 --oversubscribe '" TRUEBLADE_PROGRAM
        "' study {} > ranks.txt 2>&1",
        folder_.path().string(), limit_s, arguments);
    return WEXITSTATUS(std::system(ranks.c_str()));
  }
  std::string said() const { return text_of(folder_ / "ranks.txt"); }
};

TEST_F(RanksTest, TwoRanksGiveTheSameRows) {
  ASSERT_EQ(run_ranks("study.yaml --out ranks"), 0) << said();
  ASSERT_EQ(run({"study.yaml", "--out", "one"}).exit_code, 0);
  EXPECT_EQ(rows("ranks"), rows("one"));
}

// Whichever rank brings the outcome that shows it. All trials would take hours.
TEST_F(RanksTest, TwoRanksStopEarlyWhenEveryTrialFails) {
  write("hopeless.yaml",
        std::string(kStudy) + "sweep: [{field: registration.termination.maximum_iterations, values: [1]}]\n");
  for (const char* out : {"first", "second", "third"}) {
    EXPECT_EQ(run_ranks(fmt::format("hopeless.yaml --trials 1000000 --out {}", out)), 2) << said();
    EXPECT_NE(said().find("all of its first 100 trials failed, first trial 0: "), std::string::npos)
        << said();
  }
}

TEST_F(StudyTest, OneTrialShownAloneIsTheSameTrial) {
  ASSERT_EQ(run({"study.yaml", "--csv", "--out", "run"}).exit_code, 0);
  const ChildResult shown =
      run({"show", "study.yaml", "--trial", "31", "--case", "uniform", "--out", "trial"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "trial/scan_front.ply"));
  const Json view = Json::parse(text_of(folder_ / "trial/result.json"))["views"][0];
  const auto kept = [&](const std::string& name) { return cell("run", "31,\"uniform\"", name); };
  EXPECT_EQ(kept("front.rotation_error_rad"), view["truth"]["rotation_error_rad"].get<double>());
  EXPECT_EQ(kept("front.rms_mm"), view["rms_mm"].get<double>());
  EXPECT_EQ(kept("front.iterations"), view["iterations"].get<double>());
}

// A rotary axis that stands elsewhere displaces the points, and the best fit takes that for the place of the
// part: the reported deviations do not hold it, and neither does their error. What they hold is the noise.
TEST_F(StudyTest, AnErrorOfDeviationsIsThatOfTheReportedOnes) {
  write("axis.yaml", R"(scenario: cube.yaml
seed: 3
set:
  - {field: scan.spacing_mm, value: 2.0}
  - {field: machine.simulation.errors.YOC, value: "{sigma_mm: 0.2}"}
surfaces: [0]
)");
  const ChildResult result = run({"axis.yaml", "--trials", "40", "--csv", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  ASSERT_EQ(run({"show", "axis.yaml", "--trial", "7", "--out", "trial"}).exit_code, 0);
  const Json views = Json::parse(text_of(folder_ / "trial/result.json"))["views"];
  ASSERT_EQ(views.size(), 2u);
  for (const Json& view : views) {
    const std::string name = view["view"];
    const auto kept = [&](const std::string& quantity) {
      return cell("run", "7,\"scenario\"", name + "." + quantity);
    };
    EXPECT_EQ(kept("deviation_error_rms_mm"), view["truth"]["deviation_error_rms_mm"].get<double>()) << name;
    EXPECT_GE(std::abs(kept("deviation_error_largest_mm")), kept("deviation_error_rms_mm"));
  }
  // The axis carries the turned view off by 0.2 mm * 2 sin(10 deg), 0.07 mm; the deviations keep the sensor's
  // 3 um.
  const Json quantities = document("run")["cases"][0]["quantities"];
  EXPECT_GT(quantities["turned.translation_error_mm"]["mean"].get<double>(), 0.03);
  EXPECT_LT(quantities["turned.deviation_error_rms_mm"]["mean"].get<double>(), 0.0035);
  // Over a surface the noise averages: 40 points.
  EXPECT_LT(quantities["front.surface_0_mean_error_mm"]["standard_uncertainty"].get<double>(), 0.001);
  EXPECT_TRUE(quantities["front.surface_0_mean_error_mm"].contains("bias"));
  EXPECT_FALSE(quantities["front.deviation_error_largest_mm"].contains("bias"));
}

TEST_F(StudyTest, StatementComparisonAndPage) {
  ASSERT_EQ(run({"study.yaml", "--out", "run"}).exit_code, 0);
  const Json json = document("run");
  EXPECT_EQ(json["kind"], "virtual experiment");
  const Json& rms = json["cases"][0]["quantities"]["front.rms_mm"];
  // Every trial is there, with its numbers or among the failures.
  std::size_t failed = 0;
  for (const Json& failure : json["cases"][0]["failures"]) failed += failure["count"].get<std::size_t>();
  EXPECT_EQ(rms["values"].get<std::size_t>() + failed, 40u) << json["cases"][0]["failures"];
  // Observed 2.65 um; 3 um less six freedoms of 40 points is 2.8 um, without the rise with incidence.
  EXPECT_NEAR(rms["mean"].get<double>(), 0.0028, 0.0006);
  EXPECT_LE(rms["shortest_interval"][1].get<double>() - rms["shortest_interval"][0].get<double>(),
            rms["symmetric_interval"][1].get<double>() - rms["symmetric_interval"][0].get<double>());
  EXPECT_EQ(json["comparisons"][0]["quantities"]["front.points"]["mean_difference"], 0.0);  // the same scans
  // No estimate from these points scatters less than the bound; 40 trials know a spread to 11 %.
  for (const Json& component : json["cases"][0]["theory"]["front"]["components"]) {
    EXPECT_GT(component["spread_to_bound"].get<double>(), 0.6) << component;
    EXPECT_LT(component["spread_to_bound"].get<double>(), 1.6) << component;
  }
  const std::string page = text_of(folder_ / "run/study.html");
  EXPECT_EQ(page.find("/*DOCUMENT*/"), std::string::npos);
  for (const char* fetched : {"src=\"", "href=\"", "@import"})  // nothing is fetched
    EXPECT_EQ(page.find(fetched), std::string::npos) << fetched;
  EXPECT_NE(page.find(json["rows_hash"].get<std::string>()), std::string::npos);
}

// Who has nothing but the printed text.
TEST_F(StudyTest, ThePrintedStatementIsWhole) {
  std::string study = kStudy;
  study.insert(study.find("headline:"),
               "  - {name: a case whose name has more letters than the column has places}\n");
  write("study.yaml", study);
  const ChildResult result = run({"study.yaml", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = document("run");
  for (const std::string& words :
       {std::string("scan.spacing_mm = 2.0"),
        std::string("M = 40 trials from trial 0, seed 3, generator Philox"),
        "trueblade " + json["program_version"].get<std::string>(), rows("run"),
        std::string("Coverage probability 90 %, GUM Supplement 1"), std::string("symmetric interval"),
        std::string("shortest interval"), std::string("All cases: front.error_translation_x_mm"),
        std::string("Case \"weighted\"\n"),
        std::string("Case \"uniform\": registration.weights.source = uniform\n"), std::string("u / bound"),
        std::string("The reported covariance of view front, stated to cover 90 %, covers the true pose in"),
        // Too long for its column: a line of its own.
        std::string("\na case whose name has more letters than the column has places\n  "),
        std::string("The same trials, \"uniform\" minus \"weighted\"\n"), std::string("90 % confidence"),
        std::string("The same in every pair: front.points"),
        std::string("fixture_x: fixture on table, shift along x of the fixture\n"
                    "      normal, mean 0, standard deviation 0.1 mm; drawn once for each trial; stated in"),
        std::string("EXX:"),
        std::string("\nAnswer: front.error_translation_x_mm\n  weighted: 90 % of the trials lie from "),
        std::string("\nTerms\n  standard uncertainty (u): "), std::string("\n  coverage interval: "),
        std::string("\n  Cramer-Rao bound: ")})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << '\n' << result.out;

  // Every case in full, the failed trials with it.
  for (const Json& item : json["cases"]) {
    const std::size_t begin = result.out.find("Case \"" + item["name"].get<std::string>());
    const std::string text = result.out.substr(begin, result.out.find("\nCase ", begin) - begin);
    for (const auto& [name, quantity] : item["quantities"].items())
      EXPECT_NE(text.find("\n" + name + ' '), std::string::npos) << name;
    EXPECT_NE(text.find(item["failures"].empty() ? "No trial failed" : "Failed: "), std::string::npos)
        << text;
  }
  // The mean of a signed error is a bias; that of a size is not.
  EXPECT_TRUE(json["cases"][0]["quantities"]["front.error_translation_x_mm"].contains("bias"));
  EXPECT_FALSE(json["cases"][0]["quantities"]["front.translation_error_mm"].contains("bias"));

  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 150u) << line;
}

TEST_F(StudyTest, ThePageOpensInARealBrowser) {
  if (!has_browser()) GTEST_SKIP() << "chromium is not installed";
  write("page.yaml",
        std::string(kStudy) +
            "budget: [one_at_a_time, sobol]\n"
            "quantities: [error_translation_x_mm, error_translation_y_mm, error_translation_z_mm, "
            "u_translation_x_mm, u_translation_y_mm, u_translation_z_mm, "
            "reported_correlation_translation_xy, reported_correlation_translation_xz, "
            "reported_correlation_translation_yz]\n"
            "sweep: [{field: machine.lens.accuracy_mm, values: [0.003, 0.006]}]\n");
  ASSERT_EQ(run({"page.yaml", "--out", "run"}).exit_code, 0);
  const Json found = self_test(folder_, "run/study.html");
  ASSERT_TRUE(found.is_object());
  EXPECT_TRUE(found["errors"].empty()) << found;
  EXPECT_EQ(found["abscissa"], "machine.lens.accuracy_mm");
  EXPECT_EQ(found["statement_rows"], document("run")["cases"][0]["quantities"].size());
  for (const char* chart :
       {"histogram", "convergence", "sweep", "budget", "scatter_front_xy", "scatter_turned_xy"})
    // Lines of two pixels across a hundred, or forty points of four pixels.
    EXPECT_GT(found["painted"].value(chart, 0), 150) << chart << found;
}

TEST_F(StudyTest, InfluencesOfEveryCaseAreDeclared) {
  write("cases.yaml", R"(scenario: cube.yaml
trials: 1
set: [{field: machine.simulation.errors.fixture_x, value: "{sigma_mm: 0.1}"}]
cases:
  - {name: as it is}
  - name: other errors
    set:
      - {field: machine.simulation.errors.fixture_y, value: "{mean_mm: 0}"}
      - {field: machine.simulation.form_errors, value: "[{kind: random, amplitude_mm: 0.01}]"}
sweep: [{field: machine.lens.accuracy_mm, values: [0.003, 0.005]}]
)");
  const ChildResult result = run({"cases.yaml", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json influences = document("run")["influences"];
  const auto find = [](const Json& list, const std::string& of_case, const std::string& name) {
    for (const Json& item : list)
      if (item.value("case", "") == of_case && item["influence"].get<std::string>().starts_with(name))
        return item;
    return Json();
  };
  EXPECT_EQ(find(influences["covered"], "", "fixture_x")["provenance"], "stated in cases.yaml");
  EXPECT_EQ(find(influences["covered"], "", "fixture_c")["provenance"], "stated in cube.yaml");
  const Json& differences = influences["differences"];
  EXPECT_EQ(differences.size(), 1u + 2u + 3u) << differences;
  const Json noise = find(differences, "as it is, accuracy_mm 0.005", "sensor: noise");
  EXPECT_NE(noise["distribution"].get<std::string>().find("standard deviation 0.005 mm"), std::string::npos);
  EXPECT_EQ(find(differences, "other errors, accuracy_mm 0.003", "fixture_y")["distribution"],
            "none: not covered");
  EXPECT_EQ(find(differences, "other errors, accuracy_mm 0.003", "form error 1")["distribution"],
            "kind: random, amplitude_mm: 0.01, correlation_length_mm: 10");
  EXPECT_NE(result.out.find("case \"as it is, accuracy_mm 0.005\", sensor: noise"), std::string::npos)
      << result.out;
}

TEST_F(StudyTest, BudgetFindsTheSourceThatMatters) {
  // The offset of the sensor shifts the scan along the beam and the registration takes it for a place of the
  // part; the fixture's error is registered away.
  write("budget.yaml", R"(scenario: cube.yaml
trials: 60
set:
  - {field: scan.spacing_mm, value: 2.0}
  - {field: machine.simulation.errors.fixture_x, value: "{sigma_mm: 0.01}"}
  - {field: machine.simulation.errors.sensor_distance, value: "{sigma_mm: 0.02}"}
budget: [one_at_a_time, sobol]
quantities: [front.translation_error_mm]
headline: front.translation_error_mm
)");
  const ChildResult result = run({"budget.yaml", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("improve sensor_distance first"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n  Sobol index: "), std::string::npos) << result.out;
  const Json budget = document("run")["budget"]["front.translation_error_mm"];
  EXPECT_EQ(budget["sources"].size(), 3u);
  EXPECT_EQ(budget["improve_first"], Json::array({"sensor_distance"}));
  EXPECT_GT(budget["sources"][0]["total"].get<double>(), 0.8);
  for (std::size_t k = 1; k < 3; ++k) EXPECT_LT(budget["sources"][k]["total"].get<double>(), 0.2);
  // What 60 trials know of an index stands beside it, in the text too.
  for (const Json& source : budget["sources"])
    for (const char* error : {"first_order_error", "total_error"}) {
      EXPECT_GT(source[error].get<double>(), 0.0) << source;
      EXPECT_NE(result.out.find(fmt::format("{:.4g}", source[error].get<double>())), std::string::npos)
          << source;
    }
}

TEST_F(StudyTest, BudgetDoesNotChooseBetweenSourcesThatItCannotTellApart) {
  // The same offset along the beam, twice.
  write("budget.yaml", R"(scenario: cube.yaml
set:
  - {field: scan.spacing_mm, value: 2.0}
  - {field: scan.views, value: "[{name: front}]"}
  - {field: machine.simulation.errors.sensor_distance, value: "{sigma_mm: 0.02}"}
  - {field: machine.simulation.errors.EYY, value: "{sigma_mm: 0.02}"}
budget: [sobol]
headline: error_translation_y_mm
)");
  const ChildResult result = run({"budget.yaml", "--trials", "40", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json of_y = document("run")["budget"]["front.error_translation_y_mm"];
  EXPECT_EQ(of_y["improve_first"].size(), 2u) << of_y;
  EXPECT_EQ(of_y["advice"],
            "improve sensor_distance or EYY first (they cannot be told apart with these trials)");
  EXPECT_NE(result.out.find("improve sensor_distance or EYY first (they cannot"), std::string::npos)
      << result.out;
}

// Two trials of each, by their own names. (The budget has a test of its own.)
TEST_F(StudyTest, TheShippedStudiesRun) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes minutes under the sanitizers, which see the same code in the other tests";
#endif
  int studies = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TRUEBLADE_SOURCE_DIR "/scenarios/studies")) {
    const std::string name = entry.path().stem().string();
    if (name == "budget") continue;
    const ChildResult result = run({entry.path().string(), "--trials", "2", "--out", name});
    EXPECT_EQ(result.exit_code, 0) << name << ": " << result.err;
    ++studies;
  }
  EXPECT_EQ(studies, 7);
}

// The first block of YAML in docs/studies.md. Its tolerance, the second block, in the place of the trials.
TEST_F(StudyTest, TheExampleOfTheDocumentationRuns) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes minutes under the sanitizers, which see the same code in the other tests";
#endif
  const std::string page = text_of(TRUEBLADE_SOURCE_DIR "/docs/studies.md");
  const auto block_from = [&](std::size_t from) {
    const std::size_t begin = page.find("```yaml\n", from) + 8;
    return page.substr(begin, page.find("```", begin) - begin);
  };
  std::string example = block_from(0);
  example.replace(example.find("../"), 3, TRUEBLADE_SOURCE_DIR "/scenarios/");
  write("example.yaml", example);
  const ChildResult result = run({"example.yaml", "--trials", "2", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json quantities = document("run")["cases"][0]["quantities"];
  for (const char* name : {"front.translation_error_mm", "front.rms_mm", "front.surface_8_mean_error_mm",
                           "part.profile_airfoil_error_mm", "front.bound_translation_x_mm"})
    EXPECT_TRUE(quantities.contains(name)) << name << quantities;
  EXPECT_FALSE(quantities.contains("front.iterations"));

  const std::size_t trials = example.find("trials:");
  example.erase(trials, example.find('\n', trials) - trials + 1);
  write("stable.yaml", example + block_from(page.find("In the place of `trials`")));
  const ChildResult stable = run({"stable.yaml", "--trials", "1", "--out", "stable"});
  EXPECT_EQ(stable.exit_code, 0) << stable.err;
}

// A twisted and bowed airfoil seen edge-on: the misfit leaves distances at edges of small radius, where a
// full step of Gauss and Newton goes too far, and back. These trials once ran into the iteration limit.
TEST_F(StudyTest, AMisfitAtNarrowEdgesConverges) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes minutes under the sanitizers, which see the same code in the other tests";
#endif
  const ChildResult result = run(
      {TRUEBLADE_SOURCE_DIR "/scenarios/studies/blade_features.yaml", "--trials", "16:17", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(document("run")["cases"][0]["failures"].empty()) << result.out;
}

TEST_F(StudyTest, TheShippedBudgetRuns) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes minutes under the sanitizers, which see the same code in the budget above";
#endif
  // Two trials are the least that have a variance.
  const ChildResult result =
      run({TRUEBLADE_SOURCE_DIR "/scenarios/studies/budget.yaml", "--trials", "2", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("provenance of the machine's errors: assumed"), std::string::npos) << result.out;
  const Json budget = document("run")["budget"]["together.error_translation_y_mm"];
  EXPECT_EQ(budget["sources"].size(), 15u) << budget;
  for (const Json& source : budget["sources"]) EXPECT_TRUE(source.contains("total_error")) << source;
}

// The views of one case are those of no other: each answers with its own.
TEST_F(StudyTest, EveryCaseAnswersByItsOwnViews) {
  write("views.yaml",
        "scenario: cube.yaml\ntrials: 40\ncoverage_probability: 0.9\nset:\n  - {field: scan.spacing_mm, "
        "value: 2.0}\nheadline: rms_mm\n"
        "cases:\n  - {name: apart, views: separate}\n  - {name: at once, views: together}\n");
  const ChildResult result = run({"views.yaml", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json answer = document("run")["answer"];
  ASSERT_EQ(answer.size(), 2u) << answer;
  EXPECT_EQ(answer[0].get<std::string>().rfind("apart: 90 % of the trials lie from", 0), 0u) << answer;
  EXPECT_EQ(answer[1].get<std::string>().rfind("at once (together.rms_mm): 90 % of the trials lie from", 0),
            0u)
      << answer;
}

TEST_F(StudyTest, AdaptiveNumberOfTrials) {
  std::string study = kStudy;
  study.erase(study.find("trials: 40\n"), 11);
  write("adaptive.yaml",
        study +
            "block: 100\ntolerance: {quantity: front.rms_mm, absolute: 0.01, maximum_trials: "
            "1000}\n");
  ASSERT_EQ(run({"adaptive.yaml", "--out", "run"}).exit_code, 0);
  EXPECT_EQ(document("run")["stopping"]["blocks"], 2);
  EXPECT_EQ(document("run")["trials"], 200);
  write("strict.yaml",
        study + "block: 100\ntolerance: {quantity: front.rms_mm, absolute: 1e-9, maximum_trials: 200}\n");
  const ChildResult strict = run({"strict.yaml", "--out", "strict"});
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_NE(strict.err.find("front.rms_mm is not stable after 2 blocks of 100"), std::string::npos)
      << strict.err;
}

TEST_F(StudyTest, BadInput) {
  const auto expect_refused = [&](const std::string& text, const std::string& words) {
    write("bad.yaml", text);
    const ChildResult result = run({"bad.yaml", "--out", "bad"});
    EXPECT_EQ(result.exit_code, 2) << text << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  };
  const std::string study = kStudy;
  expect_refused(study + "sweep: [{field: scan.spacing_m, values: [1, 2]}]\n",
                 "unknown key \"spacing_m\" in scan, did you mean \"spacing_mm\"?");
  expect_refused(study + "sweep: [{field: scan.spacing_mm, values: [-1]}]\n", "must be above 0");
  expect_refused(study + "sweep: [{field: scan.views.7.theta_deg, values: [0]}]\n",
                 "must be a place in a list of 2");
  expect_refused(study + "sweeps: []\n", "did you mean \"sweep\"?");
  expect_refused("scenario: cube.yaml\ntrials: 0\n", "bad.yaml:2: trials is 0");
  expect_refused("scenario: none.yaml\n", "none.yaml: no such file");
  expect_refused("scenario: cube.yaml\nheadline: rms_m\n", "did you mean \"rms_mm\"?");
  expect_refused(study + "tolerance: {quantity: rms_mm}\n",
                 "bad.yaml:12: trials and tolerance are both given, must be one of them");
  expect_refused("scenario: cube.yaml\ntolerance: {quantity: rms_mm, maximum_trials: 100}\n",
                 "must be at least two blocks of 10000");
  expect_refused(
      "scenario: cube.yaml\nset: [{field: machine.mcs_from_part.translation_mm, value: \"[0, 0, 1e4]\"}]\n",
      "travel");
  EXPECT_EQ(run({"study.yaml", "--trials", "5:5"}).exit_code, 2);
  EXPECT_EQ(run({"study.yaml", "--trials", "many"}).exit_code, 2);
  EXPECT_EQ(run({}).exit_code, 2);
}

TEST_F(StudyTest, StopsEarlyWhenEveryTrialFails) {
  write("hopeless.yaml",
        std::string(kStudy) + "sweep: [{field: registration.termination.maximum_iterations, values: [1]}]\n");
  const ChildResult result = run({"hopeless.yaml", "--trials", "100000", "--out", "run"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("all of its first 100 trials failed, first trial 0: "), std::string::npos)
      << result.err;
  // By number, whatever else is done.
  const ChildResult later =
      run({"hopeless.yaml", "--trials", "37:100000", "--threads", "3", "--out", "later"});
  EXPECT_NE(later.err.find("first trial 37: "), std::string::npos) << later.err;
}

TEST_F(StudyTest, ScansThatMissThePartAreToldAsInAnInspection) {
  write("elsewhere.yaml", R"(scenario: cube.yaml
set: [{field: machine.simulation.errors.fixture_y, value: "{mean_mm: -60}"}]
)");
  const ChildResult result = run({"elsewhere.yaml", "--trials", "3", "--out", "run"});
  // Too few trials to stop early: the statement is written, and the reason is the last word.
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(
      result.err.find("error: case \"scenario\": no trial has a result; first trial 0: view front: none of "),
      std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("scenario: no trial has a result"), std::string::npos) << result.out;
  EXPECT_EQ(run({"merge", "elsewhere.yaml", "run/trials.sqlite", "--out", "merged"}).exit_code, 2);
  const Json failures = document("run")["cases"][0]["failures"];
  ASSERT_EQ(failures.size(), 1u) << failures;
  const std::string reason = failures[0]["reason"];
  EXPECT_NE(reason.find("view front: none of "), std::string::npos) << reason;
  EXPECT_TRUE(reason.ends_with("does the part stand where mcs_from_part says?")) << reason;
  // The same words in an inspection.
  write("elsewhere_scenario.yaml",
        std::string(kCubeScenario).replace(std::string(kCubeScenario).find("-0.3}"), 4, "-60"));
  EXPECT_NE(run_trueblade({"inspect", "elsewhere_scenario.yaml", "--out", "inspected"}, folder_.path())
                .err.find(reason),
            std::string::npos);
}

TEST_F(StudyTest, ProgressSaysNoUncertaintyOfOneTrial) {
  const ChildResult one = run({"study.yaml", "--trials", "1", "--out", "one"});
  EXPECT_NE(one.err.find("1 of 1 trials"), std::string::npos) << one.err;
  EXPECT_NE(one.err.find(": mean "), std::string::npos) << one.err;
  EXPECT_EQ(one.err.find(", u "), std::string::npos) << one.err;
  EXPECT_NE(run({"study.yaml", "--trials", "2", "--out", "two"}).err.find(", u "), std::string::npos);
}

TEST_F(StudyTest, ATrialThatLeavesThePoseUndeterminedIsAFailure) {
  write("plate.yaml",
        "scenario: " TRUEBLADE_SOURCE_DIR
        "/scenarios/failures/degenerate_part.yaml\ntrials: 100\nheadline: translation_error_mm\n");
  const ChildResult result = run({"plate.yaml", "--out", "run"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("leave 3 of 6 degrees of freedom undetermined"), std::string::npos) << result.err;
}

TEST_F(StudyTest, AFailedTrialShownAloneSaysWhyItFailed) {
  write("few.yaml", std::string(kStudy) +
                        "sweep: [{field: registration.termination.maximum_iterations, values: [100, 1]}]\n");
  const auto show = [&](const std::string& name) {
    return run({"show", "few.yaml", "--trial", "3", "--case", name, "--out", "trial"});
  };
  const ChildResult failed = show("uniform, maximum_iterations 1");
  EXPECT_EQ(failed.exit_code, 0) << failed.err;
  EXPECT_NE(
      failed.out.find("The study counts this trial as failed: front: the registration did not converge"),
      std::string::npos)
      << failed.out;
  EXPECT_EQ(show("uniform, maximum_iterations 100").out.find("counts this trial as failed"),
            std::string::npos);
}

// In this trial of the paper's case a point passes the edge between a rounding and the end plane of the root:
// the distance to the CAD surfaces must not jump there, or no step lowers the objective.
TEST_F(StudyTest, APointThatPassesAnEdgeDoesNotStopTheRegistration) {
  const ChildResult result = run(
      {TRUEBLADE_SOURCE_DIR "/scenarios/studies/paper_case.yaml", "--trials", "2464:2465", "--out", "run"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err.find("1 failed"), std::string::npos) << result.err;
}

TEST_F(StudyTest, RefusesResultsOfAnotherStudy) {
  ASSERT_EQ(run({"study.yaml", "--trials", "2", "--out", "run"}).exit_code, 0);
  write("other.yaml", std::string(kStudy) + "sweep: [{field: machine.lens.accuracy_mm, values: [0.005]}]\n");
  const ChildResult result = run({"other.yaml", "--out", "run", "--resume"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("is of another study: it has \"case: weighted"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace trueblade
