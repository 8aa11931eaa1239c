// Studies of the part as a whole, on a tapered elliptic vane whose upper half may be twisted against its
// root: errors of section features and of the offset between root and blade have no bias on a nominal part; a
// twist of known size is found; what cannot be measured is a counted failure or refused before the first
// trial.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/apps/sample_inputs.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

// Half axes 15 and 6 mm at the foot, smaller by 1 % a millimetre; surfaces "root" to 15 mm, "blade" to 40 mm.
std::string vane_obj() {
  constexpr int kAround = 160;
  std::string text;
  for (const double z : {0.0, 15.0, 40.0})
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround, scale = 1.0 - 0.01 * z;
      text += fmt::format("v {:.9f} {:.9f} {}\n", 15.0 * scale * std::cos(angle),
                          6.0 * scale * std::sin(angle), z);
    }
  text += "v 0 0 0\nv 0 0 40\n";
  for (int ring = 0; ring < 2; ++ring) {
    text += ring == 0 ? "g root\n" : "g blade\n";
    for (int i = 0; i < kAround; ++i) {
      const int a = ring * kAround + i + 1, b = ring * kAround + (i + 1) % kAround + 1;
      text += fmt::format("f {} {} {} {}\n", a, b, b + kAround, a + kAround);
      if (ring == 0)
        text += fmt::format("f {} {} {}\n", 3 * kAround + 1, b, a);
      else
        text += fmt::format("f {} {} {}\n", 3 * kAround + 2, a + kAround, b + kAround);
    }
  }
  return text;
}

constexpr const char* kVaneScenario = R"(name: vane
part: {file: vane.obj, unit: mm}
machine:
  lens: {name: long, focal_length_mm: 100, standoff_mm: 100, working_range_mm: 70, accuracy_mm: 0.003,
         spot_diameter_mm: 0.01, max_incidence_deg: 75, rate_hz: 1000}
  simulation:
    errors:
      fixture_x: {sigma_mm: 0.05}
      fixture_y: {sigma_mm: 0.05}
      fixture_c: {sigma_deg: 0.05}
scan:
  views: [{name: front}, {name: left, theta_deg: 90}, {name: back, theta_deg: 180}, {name: right, theta_deg: -90}]
  spacing_mm: 1.5
inspection:
  datum_surfaces: [root]
  sections: {heights_mm: [30], half_width_mm: 3}
  groups: [{name: root, surfaces: [root]}, {name: blade, surfaces: [blade]}]
)";

// At 30 mm the twist is 0.5 degrees * (30 - 15) / (40 - 15) = 0.3 degrees.
constexpr double kTwist_rad = 0.3 * std::numbers::pi / 180.0;
constexpr const char* kStudy = R"(scenario: vane.yaml
seed: 3
trials: 24
coverage_probability: 0.9
cases:
  - name: nominal
  - name: twisted
    set:
      - field: machine.simulation.form_errors
        value: "[{kind: airfoil_twist, axis: {root_mm: 15, tip_mm: 40}, tip_angle_deg: 0.5}]"
quantities: [section_30_twist_error_rad, section_30_displacement_x_error_mm, section_30_displacement_y_error_mm,
             section_30_chord_error_mm, section_30_maximum_thickness_error_mm, offset_blade_rotation_z_error_rad,
             offset_blade_translation_y_error_mm]
)";

class StudyPartTest : public ::testing::Test {
 protected:
  StudyPartTest() {
    folder_.write("vane.obj", vane_obj());
    folder_.write("vane.yaml", kVaneScenario);
    folder_.write("study.yaml", kStudy);
  }
  ChildResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "study");
    // Trials with sections take a quarter of a second each: minutes where other programs have the cores.
    ChildOptions options;
    options.time_limit_s = 600.0;
    return run_trueblade(arguments, folder_.path(), options);
  }

  ScratchFolder folder_;
};

// How far a mean is from zero, in its standard errors.
double standard_errors(const Json& quantity) {
  return std::abs(quantity["bias"].get<double>()) / quantity["standard_error_of_mean"].get<double>();
}

TEST_F(StudyPartTest, ErrorsOfANominalPartHaveNoBiasAndAKnownTwistIsFound) {
  const ChildResult result = run({"study.yaml", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json document = Json::parse(text_of(folder_ / "run/study.json"));
  const Json& nominal = document["cases"][0];
  EXPECT_TRUE(nominal["failures"].empty()) << nominal["failures"];
  int of_part = 0;
  for (const auto& [name, quantity] : nominal["quantities"].items()) {
    if (!name.starts_with("part.")) continue;
    ++of_part;
    EXPECT_EQ(quantity["values"], 24) << name;
    EXPECT_GT(quantity["standard_uncertainty"].get<double>(), 0.0) << name;
    // Four standard errors of a mean are left by chance in 1 of 16,000.
    EXPECT_LT(standard_errors(quantity), 4.0) << name << quantity;
  }
  EXPECT_EQ(of_part, 7);
  EXPECT_EQ(nominal["quantities"]["part.section_30_twist_error_rad"]["unit"], "rad");
  // No list of quantities drops the comparison of the views with theory.
  for (const char* view : {"front", "left", "back", "right"}) {
    EXPECT_EQ(nominal["theory"][view]["components"].size(), 6u) << view;
    EXPECT_TRUE(nominal["theory"][view].contains("coverage_of_reported_covariance")) << view;
  }
  EXPECT_EQ(document["headline"], "part.section_30_twist_error_rad");

  const Json& twisted = document["cases"][1];
  EXPECT_TRUE(twisted["failures"].empty()) << twisted["failures"];
  const Json& twist = twisted["quantities"]["part.section_30_twist_error_rad"];
  // Found, but for the rows of points: they stand 1.5 mm apart and need not lie evenly about the section, so
  // that their mean height is off by up to half of that, and the twist grows by 0.349 mrad a millimetre
  // (observed: -0.12 mrad).
  constexpr double kGrowth_rad_per_mm = 0.5 * std::numbers::pi / 180.0 / 25.0;
  EXPECT_LT(std::abs(twist["bias"].get<double>()), 0.75 * kGrowth_rad_per_mm) << twist;
}

TEST_F(StudyPartTest, AnErrorIsTheInspectionsResultMinusTheTruth) {
  ASSERT_EQ(run({"study.yaml", "--trials", "7:8", "--csv", "--out", "run"}).exit_code, 0);
  ASSERT_EQ(run({"show", "study.yaml", "--trial", "7", "--case", "twisted", "--out", "trial"}).exit_code, 0);
  const Json shown = Json::parse(text_of(folder_ / "trial/result.json"));
  double measured_rad = std::nan("");
  for (const Json& feature : shown["sections"][0]["features"])
    if (feature["name"] == "twist") measured_rad = feature["deviation"];
  const std::string csv = text_of(folder_ / "run/trials.csv");
  std::istringstream names(csv.substr(0, csv.find('\n'))), row(csv.substr(csv.find("7,\"twisted\"")));
  std::string name, cell;
  double error_rad = std::nan("");
  while (std::getline(names, name, ',') && std::getline(row, cell, ','))
    if (name == "part.section_30_twist_error_rad") error_rad = std::stod(cell);
  // The inspection's joint fit starts elsewhere and ends within its own tolerance of the same pose.
  EXPECT_NEAR(error_rad, measured_rad - kTwist_rad, 2e-6);
}

TEST_F(StudyPartTest, WhatOneViewCannotMeasureIsCounted) {
  folder_.write("one.yaml", std::string(kStudy).substr(0, std::string(kStudy).find("cases:")) +
                                "set: [{field: scan.views, value: \"[{name: front}]\"},"
                                "      {field: inspection.datum_surfaces, value: \"[]\"}]\n"
                                "quantities: [section_30_chord_error_mm, front.rms_mm]\n");
  const ChildResult result = run({"one.yaml", "--trials", "4", "--out", "run"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("No value of part.section_30_chord_error_mm: 4 of 4, first trial 0"),
            std::string::npos)
      << result.out;
  const Json quantities = Json::parse(text_of(folder_ / "run/study.json"))["cases"][0]["quantities"];
  EXPECT_EQ(quantities["front.rms_mm"]["values"], 4);
  EXPECT_EQ(quantities["part.section_30_chord_error_mm"]["values"], 0);
}

TEST_F(StudyPartTest, SurfacesAreNamedAsInAnInspection) {
  folder_.write("named.yaml", R"(scenario: vane.yaml
trials: 1
set:
  - {field: scan.spacing_mm, value: 3}
  - {field: inspection.profiles, value: "[{name: airfoil, surfaces: [blade], tolerance_mm: [-0.05, 0.05]}]"}
quantities: [rms_mm]  # drops neither surfaces nor profiles
surfaces: ["1", root]
profiles: [{name: airfoil, surfaces: [bl*]}, {name: ids, surfaces: [1]}, {name: all}]
)");
  const ChildResult result = run({"named.yaml", "--csv", "--out", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::istringstream csv(text_of(folder_ / "run/trials.csv"));
  std::string names, values, name, value;
  std::getline(csv, names);
  std::getline(csv, values);
  std::map<std::string, double> found;
  std::istringstream heads(names), cells(values);
  while (std::getline(heads, name, ',') && std::getline(cells, value, ','))
    if (name.starts_with("part.profile_") || name.starts_with("front.surface_"))
      found[name] = std::stod(value);
  EXPECT_EQ(found.count("front.surface_0_mean_error_mm"), 1u) << names;
  EXPECT_LT(names.find("front.surface_1_mean_error_mm"), names.find("front.surface_0_mean_error_mm"));
  EXPECT_EQ(found.at("part.profile_airfoil_error_mm"), found.at("part.profile_ids_error_mm"));
  EXPECT_NE(found.at("part.profile_all_error_mm"), 0.0);
  // The part is nominal: the error is the inspection's profile. Its joint fit starts elsewhere and ends
  // within its own tolerance of the same pose.
  ASSERT_EQ(run({"show", "named.yaml", "--trial", "0", "--out", "trial"}).exit_code, 0);
  const Json shown = Json::parse(text_of(folder_ / "trial/result.json"));
  EXPECT_NEAR(found.at("part.profile_airfoil_error_mm"), shown["profiles"][0]["profile_mm"].get<double>(),
              1e-5);
}

TEST_F(StudyPartTest, BadInput) {
  const auto expect_refused = [&](const std::string& more, const std::string& words) {
    folder_.write("bad.yaml", "scenario: vane.yaml\ntrials: 2\n" + more);
    const ChildResult result = run({"bad.yaml", "--out", "bad"});
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  };
  expect_refused("quantities: [section_31_twist_error_rad]\n",
                 "did you mean \"section_30_twist_error_rad\"?");
  expect_refused("set: [{field: inspection.sections.heights_mm, value: \"[50]\"}]\n", "no closed outline");
  expect_refused("set: [{field: inspection.datum_surfaces, value: \"[foot]\"}]\n",
                 "surface \"foot\" does not exist");
  // The part has two surfaces.
  expect_refused("surfaces: [0, 300]\n",
                 "bad.yaml:3: surfaces: surface \"300\" does not exist: the part has surfaces 0 to 1");
  expect_refused("profiles:\n  - {name: a, surfaces: [root]}\n  - {name: b, surfaces: [foot*]}\n",
                 "bad.yaml:5: profile b: surface \"foot*\" does not exist");
  // Another part of which the root is the second surface.
  std::string other = vane_obj();
  other.replace(other.find("g root"), 6, "g tip");
  other.replace(other.find("g blade"), 7, "g root");
  folder_.write("other.obj", other);
  expect_refused(
      "surfaces: [root]\ncases: [{name: a}, {name: b, set: [{field: part.file, value: other.obj}]}]\n",
      "surfaces and profiles name other surfaces in case \"b\" than in case \"a\"");
}

}  // namespace
}  // namespace trueblade
