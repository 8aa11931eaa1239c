// Calibration and set-up as a user meets them: the virtual machine's geometry is found through the command,
// from a measurement and from stored scans alike; what it writes is a machine file; three touched points say
// where the part stands; bad input ends with exit code 2 and a message that names it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/machine_fields.h"
#include "geometry/rigid_transform.h"
#include "tests/apps/child_process.h"

namespace trueblade {
namespace {

using Json = nlohmann::json;

// Errors to be found: 5 mrad about one normal of the beam, 0.2 mm and 1 mrad of the rotary axis.
constexpr const char* kSphereScenario = R"(name: sphere
part:
  demonstration: reference_sphere
  parameters: {diameter_mm: 20}
  chord_tolerance_mm: 0.01
machine:
  lens: {name: middle, focal_length_mm: 50, standoff_mm: 50, working_range_mm: 8, accuracy_mm: 0.003,
         spot_diameter_mm: 0.01, max_incidence_deg: 75, rate_hz: 1000}
  mcs_from_part: {translation_mm: [40, 0, 30]}
  simulation:
    errors:
      beam_a: {mean_deg: 0.286478897565}
      XOC: {mean_mm: 0.2}
      BOC: {mean_deg: 0.0572957795131}
scan:
  views: [{name: a}, {name: b, theta_deg: 90}, {name: c, theta_deg: 180}, {name: d, theta_deg: 270}]
  spacing_mm: 1.5
  max_incidence_deg: 45
  standoff_spread_mm: 2
)";

struct SphereFolder : ScratchFolder {
  SphereFolder() { write("sphere.yaml", kSphereScenario); }
};

ChildResult calibrate(const ScratchFolder& folder, std::vector<std::string> options) {
  std::vector<std::string> arguments{"machine", "calibrate"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_trueblade(arguments, folder.path());
}

TEST(Calibrate, FindsWhatTheVirtualMachineIsDrawnWith) {
  const SphereFolder folder;
  const ChildResult done = calibrate(folder, {"sphere.yaml", "--out", "geometry.yaml", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const Json json = Json::parse(done.out);
  const auto within_four_sigma = [&](const char* parameter, double truth) {
    const double u = json["standard_uncertainty"][parameter];
    EXPECT_GT(u, 0.0);
    EXPECT_NEAR(json["change"][parameter].get<double>(), truth, 4.0 * u) << parameter;
  };
  within_four_sigma("beam_tilt_1_rad", 0.005);
  within_four_sigma("beam_tilt_2_rad", 0.0);
  within_four_sigma("axis_tilt_1_rad", 0.0);
  within_four_sigma("axis_tilt_2_rad", 0.001);
  EXPECT_NEAR(json["true_change"]["beam_tilt_1_rad"].get<double>(), 0.005, 1e-7);  // sin of it: 2e-8 less
  EXPECT_NEAR(json["true_change"]["axis_tilt_2_rad"].get<double>(), 0.001, 1e-9);
  EXPECT_LT(json["standard_uncertainty"]["beam_tilt_1_rad"].get<double>(), 0.0005);
  EXPECT_LT(json["standard_uncertainty"]["axis_shift_1_mm"].get<double>(), 0.001);
  EXPECT_TRUE(json["settled"].get<bool>());
  ASSERT_EQ(json["views"].size(), 4u);

  // What was written is a machine file with the same geometry.
  const MachineSpec machine = read_machine(folder / "geometry.yaml");
  for (int k = 0; k < 3; ++k)
    EXPECT_DOUBLE_EQ(machine.geometry.beam_direction[k],
                     json["geometry"]["beam_direction"][static_cast<std::size_t>(k)].get<double>());
  EXPECT_NE(text_of(folder / "geometry.yaml").find("# Standard uncertainties"), std::string::npos);
}

TEST(Calibrate, SaysInWordsWhatHasChangedAndWhatIsNext) {
  const SphereFolder folder;
  const ChildResult done = calibrate(folder, {"sphere.yaml", "--out", "geometry.yaml"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  for (const char* words : {"beam turned about x", "beam turned about z", "rotary axis turned about y",
                            "rotary axis shifted along x", "sphere shifted along z", "true", "0.005000",
                            "Next: put its block `geometry`"})
    EXPECT_NE(done.out.find(words), std::string::npos) << words << " in\n" << done.out;
}

TEST(Calibrate, StoredScansAndAJournalGiveTheSame) {
  const SphereFolder folder;
  ASSERT_EQ(calibrate(folder, {"sphere.yaml", "--out", "geometry.yaml"}).exit_code, 0);
  ASSERT_EQ(run_trueblade({"scan", "sphere.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  const ChildResult stored = calibrate(folder, {"sphere.yaml", "--scans", "scan_a.ply", "scan_b.ply",
                                                "scan_c.ply", "scan_d.ply", "--out", "stored.yaml"});
  ASSERT_EQ(stored.exit_code, 0) << stored.err;
  EXPECT_EQ(stored.out.find("true"), std::string::npos);  // nobody knows whose scans they are
  EXPECT_EQ(text_of(folder / "stored.yaml"), text_of(folder / "geometry.yaml"));

  std::string replay = kSphereScenario;
  replay.replace(replay.find("machine:\n"), 9,
                 "machine:\n  backend: recorded\n  journal: geometry.journal\n");
  folder.write("replay.yaml", replay);
  const ChildResult replayed = calibrate(folder, {"replay.yaml", "--out", "replayed.yaml"});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_EQ(text_of(folder / "replayed.yaml"), text_of(folder / "geometry.yaml"));
}

TEST(Calibrate, BadInputIsNamed) {
  const SphereFolder folder;
  const auto refused = [&](const std::vector<std::string>& options, const char* words) {
    const ChildResult result = calibrate(folder, options);
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.yaml"));
  };
  const auto changed = [](std::string text, const std::string& from, const char* to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const auto with = [&](const char* name, const char* from, const char* to) {
    folder.write(name, changed(kSphereScenario, from, to));
    return std::string(name);
  };
  refused({"none.yaml", "--out", "x.yaml"}, "none.yaml");
  refused({with("blade.yaml", "reference_sphere\n  parameters: {diameter_mm: 20}", "turbine_blade"), "--out",
           "x.yaml"},
          "blade.yaml: the part must be the reference sphere");
  refused({with("small.yaml", "diameter_mm: 20", "diameter_mm: 0"), "--out", "x.yaml"},
          "small.yaml:4: part.parameters.diameter_mm is 0, must be between 0.1 and 1000");
  refused({with("far.yaml", "standoff_spread_mm: 2", "standoff_spread_mm: 4"), "--out", "x.yaml"},
          "standoff_spread_mm is 4, must be at least 0 and below 4");
  // Without a spread of the standoff only the errors to be found vary the distance; too little for this
  // noise.
  folder.write("flat.yaml", changed(changed(kSphereScenario, "accuracy_mm: 0.003", "accuracy_mm: 0.03"),
                                    "standoff_spread_mm: 2", "standoff_spread_mm: 0"));
  refused({"flat.yaml", "--out", "x.yaml"}, "the direction of the beam is determined to");
  refused({with("two.yaml", ", {name: c, theta_deg: 180}, {name: d, theta_deg: 270}", ""), "--out", "x.yaml"},
          "2 rotary angles, must be at least 3");
  refused({"sphere.yaml", "--scans", "none.ply", "--out", "x.yaml"}, "none.ply");
}

// Readings of a machine whose probe looks along -y from (0, 120, 60): a point of the MCS at theta = 0 is
// (x, 120 + y - distance, 60 + z). The part stands turned by 90 degrees about z and shifted by (5, 10, 20).
constexpr const char* kTouched = R"(sigma_mm: 0.2
points:
  - {name: corner, part_mm: [0, 0, 0], x_mm: 5, y_mm: -85, z_mm: -40, theta_deg: 0, distance_mm: 25}
  - {name: end, part_mm: [30, 0, 0], x_mm: 5, y_mm: -55, z_mm: -40, theta_deg: 0, distance_mm: 25}
  - {name: tip, part_mm: [0, 0, 80], x_mm: 5, y_mm: -85, z_mm: 40, theta_deg: 0, distance_mm: 25}
)";

TEST(Locate, ThreeTouchedPointsSayWhereThePartStands) {
  const ScratchFolder folder;
  folder.write("machine.yaml", "lens: {name: 25mm}\n");
  folder.write("touched.yaml", kTouched);
  const ChildResult done = run_trueblade(
      {"machine", "locate", "--machine", "machine.yaml", "--points", "touched.yaml", "--out", "part.yaml"},
      folder.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const RigidTransform found = read_machine(folder / "part.yaml").mcs_from_part;
  const RigidTransform truth{rotation_from_vector({0, 0, std::acos(0.0)}), {5, 10, 20}};
  EXPECT_LT(step_between(truth, found, Vec3::Zero()).norm(), 1e-9);
  EXPECT_NE(text_of(folder / "part.yaml").find("# Standard uncertainties"), std::string::npos);

  const ChildResult json =
      run_trueblade({"machine", "locate", "--machine", "machine.yaml", "--points", "touched.yaml", "--json"},
                    folder.path());
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const Json document = Json::parse(json.out);
  EXPECT_EQ(document["points"][2]["name"], "tip");
  EXPECT_NEAR(document["covariance"][3][3].get<double>(), 0.2 * 0.2 / 3.0, 1e-12);
}

TEST(Locate, BadInputIsNamed) {
  const ScratchFolder folder;
  folder.write("machine.yaml", "lens: {name: 25mm}\n");
  const auto refused = [&](const std::string& text, const char* words) {
    folder.write("touched.yaml", text);
    const ChildResult result = run_trueblade(
        {"machine", "locate", "--machine", "machine.yaml", "--points", "touched.yaml", "--out", "x.yaml"},
        folder.path());
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.yaml"));
  };
  const std::string touched = kTouched;
  refused(touched.substr(0, touched.find("  - {name: tip")),
          "touched.yaml: 2 points were touched, must be at least 3");
  std::string exchanged = touched;
  exchanged.replace(exchanged.find("[30, 0, 0]"), 10, "[0, 30, 0]");
  refused(exchanged +
              "  - {name: side, part_mm: [0, 50, 0], x_mm: -45, y_mm: -85, z_mm: -40, theta_deg: 0, "
              "distance_mm: 25}\n",
          "touched.yaml: the points contradict each other");
  refused("sigma_mm: -1\npoints: []\n", "touched.yaml:1: sigma_mm is -1, must be above 0");
  refused("points:\n  - {name: a}\n", "part_mm");
  // Touching needs a machine.
  const ChildResult touch = run_trueblade({"machine", "touch", "--machine", "machine.yaml", "--points",
                                           "touched.yaml", "--name", "a", "--part-mm", "0", "0", "0"},
                                          folder.path());
  EXPECT_EQ(touch.exit_code, 2);
  EXPECT_NE(touch.err.find("must be linuxcnc"), std::string::npos) << touch.err;
}

}  // namespace
}  // namespace trueblade
