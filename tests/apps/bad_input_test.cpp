// Every bad input ends with exit code 2 and a message that names the file and what is wrong, and leaves no
// half-written result. Each case is a process of its own with a time limit: no crash, no hang.
#include <gtest/gtest.h>

#include "tests/apps/sample_inputs.h"

namespace trueblade {
namespace {

struct BadInput {
  std::string what;
  std::vector<std::string> arguments;  // run in a folder that holds the files of write_inputs
  std::vector<std::string> message;    // all must appear on standard error
};

std::ostream& operator<<(std::ostream& out, const BadInput& input) {
  return out << input.what;
}

const char* const kStepHead = R"(ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));
ENDSEC;
DATA;
#1=CARTESIAN_POINT('',(0.,0.,0.));
ENDSEC;
)";

// A plane through a placement that the file does not hold, used by a face of an open shell.
std::string damaged_step() {
  return std::string(
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
      "FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));\nENDSEC;\nDATA;\n"
      "#1=PLANE('',#99);\n#2=ADVANCED_FACE('',(#98),#1,.T.);\n#3=OPEN_SHELL('',(#2));\n"
      "#4=SHELL_BASED_SURFACE_MODEL('',(#3));\n#5=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#4),#97);\n"
      "ENDSEC;\nEND-ISO-10303-21;\n");
}

std::string scenario(const std::string& part, const std::string& rest = "") {
  return "part: " + part + "\nscan: {views: [{name: front}], spacing_mm: 0.5}\n" + rest;
}

void write_inputs(const ScratchFolder& folder) {
  folder.write("cube.obj", kCubeObj);
  folder.write("cube.yaml", kCubeScenario);
  for (const char* ending : {"step", "igs", "stl", "ply", "obj", "xyz", "pcd", "yaml"})
    folder.write(std::string("empty.") + ending, "");

  folder.write("truncated.step", kStepHead);
  folder.write("nothing.step", std::string(kStepHead) + "END-ISO-10303-21;\n");
  folder.write("truncated.igs", std::string(72, ' ') + "S      1\nno more");
  folder.write("truncated.stl", std::string(80, ' ') + std::string("\x05\0\0\0", 4) + std::string(50, '\0'));
  folder.write(
      "truncated.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n");
  for (const char* ending : {"step", "igs", "stl", "ply", "obj"})
    folder.write(std::string("wrong.") + ending, "<html>not found</html>\n");
  folder.write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("inf.obj", "v 0 0 0\nv 1 0 0\nv 0 1e999 0\nf 1 2 3\n");
  folder.write("no_facets.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  // References that lead nowhere, which OpenCASCADE follows into a memory fault.
  folder.write("damaged.step", damaged_step());
  folder.write("degenerate.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  folder.write("huge_count.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
               "property float y\nproperty float z\nend_header\n");

  folder.write("two.xyz", "0 0 0\n1 0 0\n");
  folder.write("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n");
  folder.write("nan.xyz", "0 0 0\n1 0 0\nnan 1 0\n1 1 1\n");
  folder.write("word.xyz", "0 0 0\n1 0 0\n0 one 0\n1 1 1\n");
  folder.write("ragged.xyz", "0 0 0\n1 0\n0 1 0\n1 1 1\n");
  folder.write("good.xyz", "1 2 10\n5 3 10\n2 8 10\n10 2 3\n10 6 7\n10 8 1\n3 10 3\n8 10 2\n6 10 8\n");
  std::string far;  // 5 km away
  for (int i = 0; i < 9; ++i)
    far += std::to_string(5000000 + i * i % 7) + " " + std::to_string(i % 4) + " " + std::to_string(i) + "\n";
  folder.write("far.xyz", far);
  folder.write("snr.csv", "x,y,z,snr\n0,0,0,0.5\n1,0,0,1.5\n0,1,0,0.5\n0,0,1,0.5\n");
  folder.write("bad_pose.yaml", "part_from_mcs: {rotation_wxyz: [1, 1, 1, 1]}\n");
  folder.write("misspelt_options.yaml", "preset: default\nrejection:\n  rul: none\n");
  folder.write("contradiction.yaml", "step: {method: unit_quaternion}\nlock: {freedoms: [rotation_x]}\n");
  folder.write("unknown_surface.yaml", "surfaces: [7]\n");
  folder.write("plate_only.yaml", "surfaces: [1]\n");
  folder.write("two_surfaces.obj",
               std::string(kCubeObj) + "g plate\nv 90 0 0\nv 91 0 0\nv 90 1 0\nf 9 10 11\n");
  const auto with_snr = [](const char* snr) {
    std::string text = "x,y,z,snr\n";
    for (const char* point : {"1,2,10", "5,3,10", "2,8,10", "10,2,3", "10,6,7", "3,10,3", "8,10,2"})
      text += std::string(point) + "," + snr + "\n";
    return text;
  };
  folder.write("no_signal.csv", with_snr("0"));
  folder.write("weak.csv", with_snr("0.5"));
  folder.write("strong_only.yaml", "weights: {minimum_snr: 0.7}\n");
  folder.write("snr_above_1.yaml", "preset: default\nweights: {minimum_snr: 1.5}\n");
  folder.write("negative_sigma.yaml", "preset: default\ncovariance:\n  sigma_mm: -0.003\n");
  folder.write("all_locked.yaml",
               "lock: {freedoms: [rotation_x, rotation_y, rotation_z, translation_x, translation_y, "
               "translation_z]}\n");
  folder.write("a_file", "in the way\n");
  folder.write("study.yaml", "name: s\nscenario: cube.yaml\n");
  folder.write("tab.yaml", "part:\n\tfile: cube.obj\nscan: {views: [{name: front}]}\n");
  folder.write("comma.yaml", "part: {file: cube.obj, unit: cm}\nscan:\n  spacing_mm: 0,5\n");
  folder.write("comma_in_braces.yaml", "part: {file: cube.obj, unit: cm}\nscan: {spacing_mm: 0,5}\n");
  folder.write("comma_in_list.yaml", scenario("{file: cube.obj, unit: cm}",
                                              "machine: {mcs_from_part: {translation_mm: [0,5, 1, 2]}}\n"));
  folder.write(
      "expects_nothing_made.yaml",
      scenario("{file: cube.obj, unit: cm}",
               "inspection: {profiles: [{name: top, tolerance_mm: [-1, 1]}]}\n"
               "expect_part:\n  missing: {value: [0, 0]}\n  profile.top.confroming: {value: [1, 1]}\n"));

  folder.write("misspelt.yaml", scenario("{file: cube.obj, unti: cm}"));
  folder.write("out_of_range.yaml", scenario("{file: cube.obj, unit: cm, chord_tolerance_mm: 0}"));
  folder.write("no_unit.yaml", scenario("{file: cube.obj}"));
  folder.write("no_part.yaml", scenario("{file: blade.step}"));
  folder.write("part_of_others.yaml", scenario("{file: blade.ply, unit: mm, origin: the museum's archive}"));
  folder.write("bomb.yaml", "a: &a [x, x]\nb: [*a, *a]\n");
  folder.write("too_fine.yaml",
               "part: {file: cube.obj, unit: cm}\nscan: {views: [{name: front}], spacing_mm: 1e-6}\n");
  folder.write("no_such_surface.yaml",
               "part: {file: cube.obj, unit: cm}\nscan: {views: [{name: front}], surfaces: [3]}\n");
  folder.write("out_of_travel.yaml", scenario("{file: cube.obj, unit: cm}",
                                              "machine: {mcs_from_part: {translation_mm: [0, 0, 900]}}\n"));
  folder.write("home_in_part.yaml", scenario("{file: cube.obj, unit: cm}",
                                             "machine: {geometry: {stage_from_probe_at_zero: "
                                             "{translation_mm: [5, 5, 5]}}}\n"));
  folder.write(
      "turns_into_probe.yaml",
      "part: {file: cube.obj, unit: cm}\nscan: {views: [{name: front, theta_deg: 90}], spacing_mm: 0.5}\n"
      "machine: {geometry: {stage_from_probe_at_zero: {translation_mm: [0, 11.5, 0]}}}\n");
  folder.write("out_of_travel_later.yaml",
               "part: {file: cube.obj, unit: cm}\nmachine: {travel: {to: {theta_deg: 90}}}\n"
               "scan: {views: [{name: front}, {name: back, theta_deg: 180}], spacing_mm: 0.5}\n");
  folder.write("never_returns.yaml", scenario("{file: cube.obj, unit: cm}",
                                              "machine: {simulation: {sensor: {noise_to_signal: 100}}}\n"));
  // A mirror seen at 30 and 60 degrees.
  folder.write(
      "never_returns_aslant.yaml",
      "part: {file: cube.obj, unit: cm}\nscan: {views: [{name: aslant, theta_deg: 30}], spacing_mm: 0.5}\n"
      "machine: {simulation: {sensor: {finish: {specular_share: 1, lobe_exponent: 200}}}}\n");
  folder.write(
      "part_elsewhere.yaml",
      scenario("{file: cube.obj, unit: cm}", "machine: {simulation: {errors: {fixture_y: {mean_mm: 5}}}}\n"));
  folder.write("too_few_points.yaml",
               "part: {file: cube.obj, unit: cm}\nscan: {views: [{name: front}], spacing_mm: 11}\n");
  folder.write("registered_on_nothing.yaml",
               scenario("{file: cube.obj, unit: cm}", "registration: {surfaces: [1000]}\n"));
  folder.write("no_expect.yaml", scenario("{file: cube.obj, unit: cm}"));
  folder.write("misspelt_parameters.yaml", "span_mm: 60\nspam_mm: 60\n");
  folder.write("impossible_parameters.yaml", "span_mm: 60\nfillet_radius_mm: 400\n");
}

const std::vector<std::string> kRegisterCube{"register", "--part", "cube.obj", "--unit",
                                             "cm",       "--out",  "out"};

std::vector<std::string> register_cube(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = kRegisterCube;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::vector<std::string> inspect(const std::string& file) {
  return {"inspect", file, "--out", "out"};
}

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, EndsWithExitCode2AndAMessage) {
  const ScratchFolder folder;
  write_inputs(folder);
  const ChildResult result = run_trueblade(GetParam().arguments, folder.path());
  EXPECT_EQ(result.ended_by, "exit");
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(result.out, "");
  for (const std::string& words : GetParam().message)
    EXPECT_NE(result.err.find(words), std::string::npos) << "missing: " << words << "\nin: " << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out/result.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/resolved.yaml"));
  // No temporary file is left beside a result.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().string().find("tmp."), std::string::npos) << entry.path();
}

// A view that gave nothing to register: its reason is told, and the rest of the report is still made.
TEST(BadInput, AViewThatCannotBeRegisteredSaysWhy) {
  const ScratchFolder folder;
  write_inputs(folder);
  for (const auto& [file, words] :
       {std::pair{"part_elsewhere.yaml", "none of"}, std::pair{"too_few_points.yaml", "three"}}) {
    const ChildResult result = run_trueblade(inspect(file), folder.path());
    EXPECT_EQ(result.exit_code, 2) << file << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << file << result.err;
    EXPECT_NE(result.err.find("view front: "), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find("view front: view front: "), std::string::npos) << result.err;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Part, BadInputTest,
    testing::Values(
        BadInput{"missing", {"part", "info", "blade.step"}, {"blade.step", "no such file"}},
        BadInput{"a folder", {"part", "info", "."}, {"ending"}},
        BadInput{"unknown ending", {"part", "info", "a_file"}, {"a_file", ".step", ".stl"}},
        BadInput{"empty STEP", {"part", "info", "empty.step"}, {"empty.step", "empty"}},
        BadInput{"empty IGES", {"part", "info", "empty.igs"}, {"empty.igs", "empty"}},
        BadInput{"empty STL", {"part", "info", "empty.stl", "--unit", "mm"}, {"empty.stl", "empty"}},
        BadInput{"empty PLY", {"part", "info", "empty.ply", "--unit", "mm"}, {"empty.ply", "empty"}},
        BadInput{"empty OBJ", {"part", "info", "empty.obj", "--unit", "mm"}, {"empty.obj", "empty"}},
        BadInput{
            "truncated STEP", {"part", "info", "truncated.step"}, {"truncated.step", "END-ISO-10303-21"}},
        BadInput{"truncated IGES", {"part", "info", "truncated.igs"}, {"truncated.igs:2"}},
        BadInput{"truncated STL", {"part", "info", "truncated.stl", "--unit", "mm"}, {"truncated.stl", "5"}},
        BadInput{"truncated PLY", {"part", "info", "truncated.ply", "--unit", "mm"}, {"truncated.ply"}},
        BadInput{"promises 4e9 vertices",
                 {"part", "info", "huge_count.ply", "--unit", "mm"},
                 {"huge_count.ply", "4000000000"}},
        BadInput{"HTML as STEP", {"part", "info", "wrong.step"}, {"wrong.step:1", "not a STEP file"}},
        BadInput{"HTML as IGES", {"part", "info", "wrong.igs"}, {"wrong.igs:1", "not an IGES file"}},
        BadInput{"HTML as STL", {"part", "info", "wrong.stl", "--unit", "mm"}, {"wrong.stl"}},
        BadInput{
            "HTML as PLY", {"part", "info", "wrong.ply", "--unit", "mm"}, {"wrong.ply:1", "not a PLY file"}},
        BadInput{"HTML as OBJ", {"part", "info", "wrong.obj", "--unit", "mm"}, {"wrong.obj"}},
        BadInput{"STEP without a surface", {"part", "info", "nothing.step"}, {"nothing.step"}},
        BadInput{
            "STEP with references that lead nowhere", {"part", "info", "damaged.step"}, {"damaged.step"}},
        BadInput{"NaN coordinate", {"part", "info", "nan.obj", "--unit", "mm"}, {"nan.obj:2", "finite"}},
        BadInput{
            "infinite coordinate", {"part", "info", "inf.obj", "--unit", "mm"}, {"inf.obj:3", "coordinate"}},
        BadInput{
            "zero facets", {"part", "info", "no_facets.obj", "--unit", "mm"}, {"no_facets.obj", "no facets"}},
        BadInput{
            "degenerate facets only", {"part", "info", "degenerate.obj", "--unit", "mm"}, {"degenerate"}},
        BadInput{"unit missing", {"part", "info", "cube.obj"}, {"cube.obj", "unit", "mm, cm, m, in"}},
        BadInput{"unknown unit", {"part", "info", "cube.obj", "--unit", "inch"}, {"inch", "mm, cm, m, in"}},
        BadInput{"tolerance out of range",
                 {"part", "info", "cube.obj", "--unit", "cm", "--chord-tolerance-mm", "0"},
                 {"chord_tolerance_mm", "above 0"}},
        BadInput{"tolerance no number",
                 {"part", "info", "cube.obj", "--unit", "cm", "--chord-tolerance-mm", "fine"},
                 {"--chord-tolerance-mm", "fine"}},
        BadInput{"facet to an unknown format",
                 {"part", "facet", "cube.obj", "--unit", "cm", "--out", "cube.xyz"},
                 {"cube.xyz"}},
        BadInput{"unknown demonstration part",
                 {"part", "make", "blade", "--out", "b.step"},
                 {"turbine_blade", "formed_part"}},
        BadInput{
            "misspelt parameter",
            {"part", "make", "turbine_blade", "--parameters", "misspelt_parameters.yaml", "--out", "b.step"},
            {"misspelt_parameters.yaml:2", "spam_mm", "span_mm"}},
        BadInput{"impossible parameter",
                 {"part", "make", "turbine_blade", "--parameters", "impossible_parameters.yaml", "--out",
                  "b.step"},
                 {"impossible_parameters.yaml:2", "fillet_radius_mm", "400"}}));

INSTANTIATE_TEST_SUITE_P(
    Scan, BadInputTest,
    testing::Values(
        BadInput{"missing", register_cube({"--scan", "none.ply"}), {"none.ply", "no such file"}},
        BadInput{"a unit that makes it ten times the part",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "cm"}),
                 {"good.xyz", "--scan-unit", "centimetres and millimetres confused?"}},
        BadInput{"inches that are millimetres",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "in"}),
                 {"good.xyz", "--scan-unit", "inches and millimetres confused?"}},
        BadInput{"a unit that makes it a thousandth of the part",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "um"}),
                 {"good.xyz", "--scan-unit", "metres and millimetres confused?"}},
        BadInput{
            "empty XYZ", register_cube({"--scan", "empty.xyz", "--scan-unit", "mm"}), {"empty.xyz", "empty"}},
        BadInput{
            "empty PLY", register_cube({"--scan", "empty.ply", "--scan-unit", "mm"}), {"empty.ply", "empty"}},
        BadInput{
            "empty PCD", register_cube({"--scan", "empty.pcd", "--scan-unit", "mm"}), {"empty.pcd", "empty"}},
        BadInput{"truncated PLY",
                 register_cube({"--scan", "truncated.ply", "--scan-unit", "mm"}),
                 {"truncated.ply"}},
        BadInput{"promises 4e9 points",
                 register_cube({"--scan", "huge_count.ply", "--scan-unit", "mm"}),
                 {"huge_count.ply", "4000000000"}},
        BadInput{"HTML as PLY", register_cube({"--scan", "wrong.ply", "--scan-unit", "mm"}), {"wrong.ply:1"}},
        BadInput{
            "unknown ending", register_cube({"--scan", "cube.yaml", "--scan-unit", "mm"}), {"cube.yaml"}},
        BadInput{"unit missing", register_cube({"--scan", "good.xyz"}), {"good.xyz", "unit"}},
        BadInput{"NaN", register_cube({"--scan", "nan.xyz", "--scan-unit", "mm"}), {"nan.xyz:3", "finite"}},
        BadInput{"a word", register_cube({"--scan", "word.xyz", "--scan-unit", "mm"}), {"word.xyz:3", "one"}},
        BadInput{"a line too short",
                 register_cube({"--scan", "ragged.xyz", "--scan-unit", "mm"}),
                 {"ragged.xyz:2"}},
        BadInput{
            "SNR above 1", register_cube({"--scan", "snr.csv", "--scan-unit", "mm"}), {"snr.csv:3", "1.5"}},
        BadInput{"two points", register_cube({"--scan", "two.xyz", "--scan-unit", "mm"}), {"three"}},
        BadInput{"points on one line",
                 register_cube({"--scan", "line.xyz", "--scan-unit", "mm"}),
                 {"line", "three non-collinear"}},
        BadInput{"kilometres away",
                 register_cube({"--scan", "far.xyz", "--scan-unit", "mm"}),
                 {"initial pose", "mm from the part"}},
        BadInput{"initial pose missing",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--initial", "none.yaml"}),
                 {"none.yaml", "no such file"}},
        BadInput{"initial pose no rotation",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--initial", "bad_pose.yaml"}),
                 {"bad_pose.yaml:1", "unit quaternion"}},
        BadInput{"unknown preset",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--preset", "zhu2006"}),
                 {"zhu2006", "default, zhu2007"}},
        BadInput{
            "misspelt option",
            register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--options", "misspelt_options.yaml"}),
            {"misspelt_options.yaml:3", "\"rul\"", "did you mean \"rule\""}},
        BadInput{
            "options that contradict",
            register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--options", "contradiction.yaml"}),
            {"contradiction.yaml:2", "lock.freedoms"}},
        BadInput{
            "unknown surface",
            register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--options", "unknown_surface.yaml"}),
            {"surface", "7"}},
        BadInput{"a selection that leaves nothing",
                 {"register", "--part", "two_surfaces.obj", "--unit", "cm", "--scan", "good.xyz",
                  "--scan-unit", "mm", "--out", "out", "--options", "plate_only.yaml"},
                 {"surfaces [", "points are closest to them; at least three are needed"}},
        BadInput{"no point has weight",
                 register_cube({"--scan", "no_signal.csv", "--scan-unit", "mm"}),
                 {"0 of 7 scan points have weight", "at least three"}},
        BadInput{"the SNR filter leaves nothing",
                 register_cube({"--scan", "weak.csv", "--scan-unit", "mm", "--options", "strong_only.yaml"}),
                 {"weights.minimum_snr 0.7", "at least three"}},
        BadInput{"SNR filter out of range",
                 register_cube({"--scan", "weak.csv", "--scan-unit", "mm", "--options", "snr_above_1.yaml"}),
                 {"snr_above_1.yaml:2", "weights.minimum_snr is 1.5", "within 0 to 1"}},
        BadInput{
            "negative sigma",
            register_cube({"--scan", "weak.csv", "--scan-unit", "mm", "--options", "negative_sigma.yaml"}),
            {"negative_sigma.yaml:3", "covariance.sigma_mm is -0.003", "above 0"}},
        BadInput{"all freedoms locked",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--options", "all_locked.yaml"}),
                 {"all_locked.yaml:1", "locks all six"}},
        BadInput{"preset and options",
                 register_cube({"--scan", "good.xyz", "--scan-unit", "mm", "--preset", "default", "--options",
                                "contradiction.yaml"}),
                 {"--preset", "--options"}},
        BadInput{"output under a file",
                 {"register", "--part", "cube.obj", "--unit", "cm", "--scan", "good.xyz", "--scan-unit", "mm",
                  "--out", "a_file/out"},
                 {"a_file"}}));

INSTANTIATE_TEST_SUITE_P(
    Scenario, BadInputTest,
    testing::Values(
        BadInput{"missing", inspect("none.yaml"), {"none.yaml", "no such file"}},
        BadInput{"empty", inspect("empty.yaml"), {"empty.yaml", "empty"}},
        BadInput{"a folder", inspect("."), {"not a regular file"}},
        BadInput{"not YAML", inspect("wrong.stl"), {"wrong.stl"}},
        BadInput{"a part", inspect("cube.obj"), {"cube.obj: is a part, must be a scenario", "part info"}},
        BadInput{"a scan", inspect("good.xyz"), {"good.xyz: is a scan, must be a scenario", "register"}},
        BadInput{"a part for a study", {"study", "cube.obj"}, {"cube.obj: is a part, must be a study"}},
        BadInput{"a study",
                 inspect("study.yaml"),
                 {"study.yaml:2: this is a study, must be a scenario", "`trueblade study`"}},
        BadInput{"a scenario for a study",
                 {"study", "cube.yaml"},
                 {"cube.yaml:3: this is a scenario, must be a study", "`trueblade inspect`"}},
        BadInput{"a tab", inspect("tab.yaml"), {"tab.yaml:2: is indented with a tab, must be with spaces"}},
        BadInput{"a decimal comma",
                 inspect("comma.yaml"),
                 {"comma.yaml:3: scan.spacing_mm is \"0,5\", must be a number with a decimal point: 0.5"}},
        BadInput{"a decimal comma in braces",
                 inspect("comma_in_braces.yaml"),
                 {"comma_in_braces.yaml:2: spacing_mm is \"0,5\"", "decimal point: 0.5"}},
        BadInput{"a decimal comma in a list",
                 inspect("comma_in_list.yaml"),
                 {"translation_mm has 4 numbers, must have 3; they are read as 0 and 5 and 1 and 2"}},
        BadInput{"a promise about nothing that is made",
                 {"plan", "expects_nothing_made.yaml", "--out", "out"},
                 {"expects_nothing_made.yaml:6: expect_part.profile.top.confroming",
                  "did you mean \"profile.top.conforming\""}},
        BadInput{"misspelt key",
                 inspect("misspelt.yaml"),
                 {"misspelt.yaml:1", "\"unti\"", "did you mean \"unit\""}},
        BadInput{"value out of range",
                 inspect("out_of_range.yaml"),
                 {"out_of_range.yaml:1", "chord_tolerance_mm is 0", "above 0"}},
        BadInput{"unit missing", inspect("no_unit.yaml"), {"cube.obj", "unit"}},
        BadInput{"part missing", inspect("no_part.yaml"), {"blade.step", "no such file"}},
        BadInput{"part missing that comes from elsewhere",
                 inspect("part_of_others.yaml"),
                 {"blade.ply: no such file; it is not part of this project: the museum's archive"}},
        BadInput{"aliases", inspect("bomb.yaml"), {"bomb.yaml:1", "aliases"}},
        BadInput{"a raster of 1e14 cells", inspect("too_fine.yaml"), {"spacing_mm", "cells"}},
        BadInput{"unknown surface", inspect("no_such_surface.yaml"), {"surface 3"}},
        BadInput{
            "unknown surface of the registration", inspect("registered_on_nothing.yaml"), {"1000", "0 to 0"}},
        BadInput{"seed below 0", {"inspect", "cube.yaml", "--seed", "-4"}, {"--seed", "-4", "whole number"}},
        BadInput{"scan that is no PLY", {"scan", "cube.yaml", "--out", "out.xyz"}, {"out.xyz", ".ply"}},
        BadInput{"beyond the travel", inspect("out_of_travel.yaml"), {"front", "z"}},
        BadInput{"beyond the travel in a later view",
                 inspect("out_of_travel_later.yaml"),
                 {"view back", "theta is 180", "-5729.578 and 90"}},
        BadInput{"home inside the part",
                 {"plan", "home_in_part.yaml", "--out", "out"},
                 {"view front", "the way to planned line 1", "the probe would touch the part"}},
        BadInput{"home where the part turns",
                 {"plan", "turns_into_probe.yaml", "--out", "out"},
                 {"view front", "the table would turn while the probe stands in the way"}},
        BadInput{"a beam that never returns",
                 inspect("never_returns.yaml"),
                 {"the beam would never return", "noise_to_signal (100)"}},
        BadInput{"a beam that never returns from the planned incidences",
                 inspect("never_returns_aslant.yaml"),
                 {"view aslant: the beam would never return", "below missed_snr (0.02)"}},
        BadInput{"the same by the plan",
                 {"plan", "never_returns_aslant.yaml", "--out", "out"},
                 {"view aslant", "planned points would send no light back"}},
        BadInput{"range image missing", {"image", "none.exr"}, {"none.exr", "missing"}},
        BadInput{"range image of another format", {"image", "wrong.ply"}, {"wrong.ply", "OpenEXR"}},
        BadInput{"plan and its angles contradict",
                 {"plan", "cube.yaml", "--automatic", "--theta-deg", "10"},
                 {"--theta-deg", "excludes"}},
        BadInput{"output under a file", {"inspect", "cube.yaml", "--out", "a_file/out"}, {"a_file"}},
        BadInput{"output is a file", {"inspect", "cube.yaml", "--out", "a_file"}, {"a_file"}},
        BadInput{"output in a folder that takes none",
                 {"inspect", "cube.yaml", "--out", "/proc/trueblade"},
                 {"/proc/trueblade"}},
        BadInput{"scan under a file", {"scan", "cube.yaml", "--out", "a_file/scan.ply"}, {"a_file"}},
        BadInput{"negative seed", {"inspect", "cube.yaml", "--seed", "-1"}, {"--seed"}},
        BadInput{"seed of words", {"inspect", "cube.yaml", "--seed", "one"}, {"--seed", "one"}}));

INSTANTIATE_TEST_SUITE_P(
    Usage, BadInputTest,
    testing::Values(
        BadInput{"no command", {}, {"trueblade: error: ", "--help"}},
        BadInput{"misspelt command",
                 {"inspct", "cube.yaml"},
                 {"\"trueblade inspct\"", "did you mean \"inspect\""}},
        BadInput{"unknown command", {"frobnicate"}, {"inspect, plan, scan, register, part, regress"}},
        BadInput{"misspelt part command", {"part", "inof", "cube.obj"}, {"did you mean \"info\""}},
        BadInput{"misspelt option",
                 {"inspect", "cube.yaml", "--sed", "3"},
                 {"trueblade: error: ", "--sed", "did you mean \"--seed\""}},
        BadInput{"missing argument",
                 {"study", "show", "study.yaml"},
                 {"trueblade: error: --trial is required (`trueblade study show --help` explains)"}},
        BadInput{"missing option", {"scan", "cube.yaml"}, {"--out"}}));

}  // namespace
}  // namespace trueblade
