// Covers: defaults of a scenario; that what is written (resolved.yaml) reads back to the same scenario, for
// every scenario of the project and for one that departs from every default; the messages of bad scenarios.
#include "apps/scenario.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/apps/child_process.h"

namespace trueblade {
namespace {

const char* const kSmallest = R"(part: {demonstration: turbine_blade}
scan: {views: [{name: front}]}
)";

Scenario read(const std::string& text) {
  const ScratchFolder scratch;
  return read_scenario(scratch.write("case.yaml", text));
}

// The message without the folder in front.
std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& failure) {
    const std::string message = failure.what();
    return message.substr(message.find("case.yaml"));
  }
  return "no error";
}

TEST(Scenario, TheSmallestHasDefaults) {
  const Scenario scenario = read(kSmallest);
  EXPECT_EQ(scenario.name, "case");
  EXPECT_EQ(scenario.seed, 1u);
  EXPECT_EQ(scenario.machine.lens.name, "25mm");
  EXPECT_EQ(scenario.machine.lens.working_range_mm, 0.7);
  EXPECT_EQ(scenario.registration.preset, "default");
  EXPECT_EQ(scenario.part.options.faceting.chord_tolerance_mm, FacetingOptions().chord_tolerance_mm);
  EXPECT_TRUE(scenario.expect.empty());
}

TEST(Scenario, PathsAreRelativeToItsFolder) {
  const ScratchFolder scratch;
  const Scenario scenario = read_scenario(
      scratch.write("case.yaml", "part: {file: sub/../blade.ply, unit: mm}\nscan: {views: [{name: a}]}\n"));
  EXPECT_EQ(scenario.part.file, scratch / "blade.ply");
}

TEST(Scenario, OverridesOfAPresetKeepTheRestOfIt) {
  const Scenario scenario =
      read(std::string(kSmallest) + "registration: {preset: zhu2007, rejection: {rule: none}}\n");
  RegistrationOptions expected = preset("zhu2007");
  expected.rejection.rule = RejectionRule::none;
  EXPECT_EQ(scenario.registration.options.rejection.rule, RejectionRule::none);
  EXPECT_EQ(scenario.registration.options.step.method, expected.step.method);
  EXPECT_EQ(scenario.registration.options.closest_point.search, expected.closest_point.search);
}

const char* const kOwnLenses =
    "lenses:\n  own: {focal_length_mm: 60, standoff_mm: 61, working_range_mm: 5, accuracy_mm: 0.01, "
    "spot_diameter_mm: 0.02, max_incidence_deg: 70, rate_hz: 500, verified: no}\n";

TEST(Scenario, TakesItsMachineFromAFileAndOverridesIt) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "machines");
  scratch.write("machines/lenses.yaml", kOwnLenses);
  scratch.write("machines/m.yaml",
                "lens: {table: lenses.yaml, name: own}\ntravel: {to: {x_mm: 77}}\n"
                "mcs_from_fixture: {translation_mm: [0, 0, 5]}\n");
  const Scenario scenario = read_scenario(scratch.write(
      "case.yaml", std::string(kSmallest) + "machine: {file: machines/m.yaml, travel: {to: {y_mm: "
                                            "88}}, lens: {accuracy_mm: 0.02}}\n"));
  EXPECT_EQ(scenario.machine.lens.name, "own");
  EXPECT_EQ(scenario.machine.lens.standoff_mm, 61.0);
  EXPECT_EQ(scenario.machine.lens.accuracy_mm, 0.02);
  EXPECT_FALSE(scenario.machine.lens.verified);
  EXPECT_EQ(scenario.machine.limits.upper.x_mm, 77.0);
  EXPECT_EQ(scenario.machine.limits.upper.y_mm, 88.0);
  EXPECT_EQ(scenario.machine.mcs_from_fixture.translation_mm.z(), 5.0);
}

// The table for users and the lenses that the library knows say the same.
TEST(Scenario, LensTableOfTheProjectHoldsThePapersLenses) {
  for (const char* name : {"25mm", "100mm"}) {
    const Scenario scenario = read(
        std::string(kSmallest) +
        "machine: {lens: {table: " TRUEBLADE_SOURCE_DIR "/scenarios/machines/lenses.yaml, name: " + name +
        "}}\n");
    const Lens& lens = scenario.machine.lens;
    const Lens known = standard_lens(name);
    EXPECT_TRUE(lens.verified);
    EXPECT_EQ(lens.focal_length_mm, known.focal_length_mm);
    EXPECT_EQ(lens.standoff_mm, known.standoff_mm);
    EXPECT_EQ(lens.working_range_mm, known.working_range_mm);
    EXPECT_EQ(lens.accuracy_mm, known.accuracy_mm);
    EXPECT_EQ(lens.accuracy_is_limit, known.accuracy_is_limit);
    EXPECT_EQ(lens.spot_diameter_mm, known.spot_diameter_mm);
    EXPECT_DOUBLE_EQ(lens.max_incidence_rad, known.max_incidence_rad);
    EXPECT_EQ(lens.rate_hz, known.rate_hz);
  }
}

TEST(Scenario, FinishIsNamedOrStated) {
  const auto finish_of = [](const std::string& finish) {
    return read(std::string(kSmallest) + "machine: {simulation: {sensor: {finish: {" + finish + "}}}}\n")
        .machine.simulation.sensor.finish;
  };
  EXPECT_EQ(finish_of("kind: polished").specular_share, polished_finish().specular_share);
  EXPECT_EQ(finish_of("kind: polished, lobe_exponent: 77").lobe_exponent, 77.0);
}

TEST(Scenario, ChoosesViewsItselfWhenAsked) {
  const Scenario scenario = read(
      "part: {demonstration: turbine_blade}\nscan: {automatic_views: {most_views: 3, candidate_step_deg: "
      "15}}\n");
  ASSERT_TRUE(scenario.scan.automatic_views);
  EXPECT_EQ(scenario.scan.automatic_views->most_views, 3u);
  EXPECT_TRUE(scenario.scan.views.empty());
}

void expect_identity(const Scenario& scenario) {
  const std::string written = scenario_text(scenario);
  const ScratchFolder scratch;
  const Scenario back = read_scenario(scratch.write("resolved.yaml", written));
  // The text holds every field, with as many digits as tell two numbers apart.
  EXPECT_EQ(scenario_text(back), written);
}

TEST(Scenario, WrittenReadsBackToTheSame) {
  expect_identity(read(kSmallest));
  expect_identity(
      read("part: {demonstration: turbine_blade}\nscan: {automatic_views: {least_gain: 0.01}}\n"));
  expect_identity(read(std::string(kSmallest) +
                       "registration: {preset: zhu2007, acceleration: {maximum_angle_deg: 9.9}}\n"));
}

TEST(Scenario, WrittenReadsBackToTheSameWithoutADefaultLeft) {
  const Scenario scenario = read(R"(
name: all-of_it
description: "with: a colon"
seed: 18446744073709551615
part: {file: /nowhere/part.step, chord_tolerance_mm: 0.003, angular_tolerance_deg: 7.3}
machine:
  lens: {name: own, focal_length_mm: 33, standoff_mm: 40.1, working_range_mm: 1.7, accuracy_mm: 0.001,
         spot_diameter_mm: 0.01, max_incidence_deg: 61.7, rate_hz: 333}
  geometry:
    linear_axis_1: z
    linear_axis_3: x
    beam_direction: [0, 0.6, 0.8]
    rotary_axis_point_mm: [1, 2, 3.3]
    stage_from_probe_at_zero: {rotation_wxyz: [0.5, 0.5, 0.5, 0.5], translation_mm: [0.1, 0.2, 0.3]}
  travel: {from: {x_mm: -1, theta_deg: -33.3}, to: {z_mm: 77.7}}
  dynamics: {speed: {theta_deg_per_s: 12.3}, acceleration: {x_mm_per_s2: 1000}}
  mcs_from_part: {rotation_wxyz: [0.6, 0, 0.8, 0], translation_mm: [0.1, 0.7, -3]}
  mcs_from_fixture: {translation_mm: [0, 0, 32.1]}
  probe: {radius_mm: 12, length_mm: 99, aperture_radius_mm: 2.5, clearance_mm: 0.7}
  simulation:
    part_surface: exact
    form_errors:
      - {kind: platform_shift, top_mm: 0.5, blend_mm: 2, shift_mm: [0, 0.1, 0]}
      - {kind: random, amplitude_mm: 0.01, correlation_length_mm: 7}
    sensor: {noise_scale: 0.5, speckle: 0.1, finish: {specular_share: 0.3, lobe_exponent: 12}, quantisation_mm: 0.001,
             exposure_s: 0.002, spot_scale: 2, contrast_depth_mm: 0.03, multiple_reflection: 0.2}
    errors:
      fixture_x: {mean_mm: 0.2, sigma_mm: 0.1}
      fixture_c: {mean_deg: 0.3, sigma_deg: 0.07, scope: view}
      drift_z: {mean_mm_per_s: 0.001}
      time_base: {sigma_s: 0.0001, scope: line}
scan:
  views: [{name: front}, {name: back, theta_deg: 180}]
  spacing_mm: 0.7
  surfaces: [3, 1, 4]
  max_incidence_deg: 55.5
registration:
  preset: zhu2007
  step: {method: point_to_plane}
  acceleration: {method: none}
  covariance: {sigma_mm: 0.003}
  lock: {freedoms: [rotation_x, translation_z], part_from_frame: {translation_mm: [0, 0, 1]}}
  surfaces: [7]
inspection: {surface: facets, tolerance_mm: [-0.1, 0.2], colour_limit_mm: 0.05, colour_map: blue_white_orange}
expect:
  front: {rms_mm: [0.001, 0.002], points: [3000, 3500]}
)");
  EXPECT_EQ(scenario.machine.simulation.errors[ErrorSource::fixture_c].scope, ErrorScope::view);
  EXPECT_EQ(scenario.registration.options.lock.freedoms.size(), 2u);
  EXPECT_DOUBLE_EQ(*scenario.scan.max_incidence_rad, radians_from_degrees(55.5));
  expect_identity(scenario);
}

TEST(Scenario, EveryScenarioOfTheProjectReadsBackToTheSame) {
  int scenarios = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TRUEBLADE_SOURCE_DIR "/scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    expect_identity(read_scenario(entry.path()));
    ++scenarios;
  }
  EXPECT_GT(scenarios, 0);
}

struct Defect {
  std::string text;
  std::string message;  // or its beginning
};

class ScenarioDefect : public testing::TestWithParam<Defect> {};

TEST_P(ScenarioDefect, IsNamedWithFileAndLine) {
  const std::string message = error_of(GetParam().text);
  EXPECT_EQ(message.substr(0, GetParam().message.size()), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    All, ScenarioDefect,
    testing::Values(
        Defect{"scan: {views: [{name: a}]}\n", "case.yaml:1: part is missing"},
        Defect{"part: {demonstration: turbine_blade}\n", "case.yaml:1: scan is missing"},
        Defect{"part: {}\nscan: {views: [{name: a}]}\n",
               "case.yaml:1: part must have either file or demonstration"},
        Defect{"part: {demonstration: turbine_blade, file: x.stp}\nscan: {views: [{name: a}]}\n",
               "case.yaml:1: part must have either file or demonstration"},
        Defect{"part: {demonstration: turbine_blad}\nscan: {views: [{name: a}]}\n",
               "case.yaml:1: part.demonstration is \"turbine_blad\", did you mean \"turbine_blade\"?"},
        Defect{"part: {file: x.stl, unit: mn}\nscan: {views: [{name: a}]}\n",
               "case.yaml:1: part.unit is \"mn\", did you mean \"mm\"? It must be one of mm, cm, m, in, um"},
        Defect{"part:\n  file: x.stp\n  chord_tolerance_mm: -0.01\nscan: {views: [{name: a}]}\n",
               "case.yaml:3: part.chord_tolerance_mm is -0.01"},
        Defect{"part:\n  file: x.stp\n  angular_tolerance_deg: 200\nscan: {views: [{name: a}]}\n",
               "case.yaml:3: part.angular_tolerance_rad is 3.49"},
        Defect{"part:\n  demonstration: turbine_blade\n  parameters:\n    span_mm: -3\nscan: {views: [{name: "
               "a}]}\n",
               "case.yaml:4: part.parameters.span_mm is -3"},
        Defect{std::string(kSmallest) + "machine:\n  lens: {name: 24mm}\n",
               "case.yaml:4: lens is \"24mm\", must be one of 25mm, 100mm, or state its focal_length_mm"},
        Defect{std::string(kSmallest) + "machine:\n  lens:\n    name: 25mm\n    accuracy_mm: 0\n",
               "case.yaml:6: lens 25mm: machine.lens.accuracy_mm is 0"},
        Defect{std::string(kSmallest) + "machine: {backend: linuxnc}\n",
               "case.yaml:3: machine.backend is \"linuxnc\""},
        Defect{std::string(kSmallest) + "machine:\n  geometry:\n    beam_direction: [0, 0, 2]\n",
               "case.yaml:5: machine.geometry.beam_direction has length 2"},
        Defect{std::string(kSmallest) + "machine: {travel: {from: {x_mm: 5}, to: {x_mm: 3}}}\n",
               "case.yaml:3: travel of x: from 5 to 3 mm"},
        Defect{std::string(kSmallest) + "machine:\n  lens:\n    working_range_mm: 60\n",
               "case.yaml:5: lens 25mm: machine.lens.working_range_mm is 60, must be below twice the "
               "standoff_mm"},
        Defect{std::string(kSmallest) + "machine:\n  probe:\n    radius_mm: 0\n",
               "case.yaml:5: probe body: machine.probe.radius_mm is 0, must be above 0"},
        Defect{std::string(kSmallest) + "machine:\n  dynamics: {speed: {x_mm_per_s: 0}}\n",
               "case.yaml:4: machine.dynamics.speed.x_mm_per_s is 0, must be above 0"},
        Defect{std::string(kSmallest) + "machine:\n  geometry:\n    y_direction: [1, 0, 0]\n",
               "case.yaml:5: axis_direction: x, y and z span a volume of 0"},
        Defect{"part: {demonstration: turbine_blade}\nscan:\n  views: [{name: a}]\n  automatic_views: {}\n",
               "case.yaml:3: scan must have either views or automatic_views, not both"},
        Defect{std::string(kSmallest) + "machine: {simulation: {errors: {fixture_x: {sigma_mm: -0.1}}}}\n",
               "case.yaml:3: machine.simulation.errors.fixture_x.sigma_mm is -0.1, must be at least 0"},
        Defect{std::string(kSmallest) + "machine: {simulation: {errors: {fixture_x: {sigma_deg: 0.1}}}}\n",
               "case.yaml:3: unknown key \"sigma_deg\" in machine.simulation.errors.fixture_x"},
        Defect{std::string(kSmallest) + "machine: {simulation: {errors: {fixtur_x: {sigma_mm: 0.1}}}}\n",
               "case.yaml:3: unknown key \"fixtur_x\" in machine.simulation.errors, did you mean "
               "\"fixture_x\"?"},
        Defect{"part: {demonstration: turbine_blade}\nscan: {views: []}\n",
               "case.yaml:2: scan.views is empty, must hold at least one view"},
        Defect{"part: {demonstration: turbine_blade}\nscan:\n  views: [{name: a}, {name: a}]\n",
               "case.yaml:3: scan.views holds \"a\" twice, names must differ"},
        Defect{
            "part: {demonstration: turbine_blade}\nscan:\n  views: [{name: ../../etc/x}]\n",
            "case.yaml:3: scan.views[0].name is \"../../etc/x\", must be 1 to 100 letters, digits, _ or -"},
        Defect{"part: {demonstration: turbine_blade}\nscan:\n  views: [{name: a}]\n  spacing_mm: 0\n",
               "case.yaml:4: scan.spacing_mm is 0, must be above 0"},
        Defect{std::string(kSmallest) + "registration:\n  preset: defualt\n",
               "case.yaml:4: registration.preset is defualt, must be one of default, zhu2007"},
        Defect{std::string(kSmallest) + "registration:\n  rejection:\n    cut_sigma: -1\n",
               "case.yaml:5: registration.rejection.cut_sigma is -1"},
        Defect{std::string(kSmallest) + "registration:\n  rejection: {rule: three_sigmas}\n",
               "case.yaml:4: registration.rejection.rule is \"three_sigmas\", did you mean \"three_sigma\"?"},
        Defect{std::string(kSmallest) + "registration:\n  lock: {freedoms: [rotation_w]}\n",
               "case.yaml:4: registration.lock.freedoms is rotation_w, must be one of"},
        Defect{std::string(kSmallest) + "expect: {back: {rms_mm: [0, 1]}}\n",
               "case.yaml:3: expect.back is not among the views of scan"},
        Defect{std::string(kSmallest) + "expect: {front: {rms: [0, 1]}}\n",
               "case.yaml:3: unknown key \"rms\" in expect.front"}));

}  // namespace
}  // namespace trueblade
