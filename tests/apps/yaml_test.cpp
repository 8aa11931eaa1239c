// Covers: reading of every kind of field; writing and reading back to the same bits; each defect of a YAML
// file with the file, line, value and constraint that its message must name; inputs made to exhaust memory.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/yaml_reader.h"
#include "apps/yaml_writer.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

enum class Shade { light, dark };
constexpr std::pair<std::string_view, Shade> kShades[] = {{"light", Shade::light}, {"dark", Shade::dark}};

struct Item {
  std::string name;
  double angle_rad = 0.0;
};

struct Sample {
  double length_mm = 1.0;
  std::optional<double> limit_mm;
  double angle_rad = 0.5;
  std::uint64_t seed = 0;
  int count = 1;
  bool on = false;
  std::string title = "none";
  Vec3 place_mm = Vec3::Zero();
  Vec3 tilt_rad = Vec3::Zero();
  std::optional<std::pair<double, double>> range;
  std::vector<std::string> names;
  RigidTransform pose;
  Shade shade = Shade::light;
  std::optional<Item> extra;
  std::vector<Item> items;
  std::map<std::string, Item> by_name;
};

void fields(YamlFields& io, Item& item) {
  io.require("name");
  io.text("name", item.name);
  io.angle("angle_deg", item.angle_rad, between(-180.0, 180.0));
}

void fields(YamlFields& io, Sample& sample) {
  const auto item = [](YamlFields& inner, Item& value) { fields(inner, value); };
  io.number("length_mm", sample.length_mm, above(0.0));
  io.number("limit_mm", sample.limit_mm);
  io.angle("angle_deg", sample.angle_rad);
  io.integer("seed", sample.seed, 0, std::numeric_limits<std::uint64_t>::max());
  io.integer("count", sample.count, 1, 10);
  io.flag("on", sample.on);
  io.text("title", sample.title);
  io.vector("place_mm", sample.place_mm);
  io.angles("tilt_deg", sample.tilt_rad);
  io.interval("range", sample.range);
  io.texts("names", sample.names);
  io.pose("pose", sample.pose);
  io.choice<Shade>("shade", sample.shade, kShades);
  io.optional_map<Item>("extra", sample.extra, item);
  io.list<Item>("items", sample.items, item);
  io.named<Item>("by_name", sample.by_name, item);
}

Sample read(const std::string& text) {
  Sample sample;
  read_yaml_text(text, "sample.yaml", [&](YamlFields& io) { fields(io, sample); });
  return sample;
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& failure) {
    return failure.what();
  }
  return "no error";
}

TEST(YamlReader, ReadsEveryKindOfField) {
  const Sample sample = read(R"(
length_mm: 2.5
limit_mm: 1e-3
angle_deg: 180
seed: 18446744073709551615
count: 7
on: true
title: "a: title"
place_mm: [1, -2, 3.5]
tilt_deg: [0, 90, 0]
range: [0.1, 0.2]
names: [a, b]
pose: {rotation_wxyz: [0, 1, 0, 0], translation_mm: [1, 2, 3]}
shade: dark
extra: {name: e}
items:
  - {name: first, angle_deg: 90}
  - name: second
by_name:
  front: {name: f}
)");
  EXPECT_EQ(sample.length_mm, 2.5);
  EXPECT_EQ(sample.limit_mm, 1e-3);
  EXPECT_DOUBLE_EQ(sample.angle_rad, M_PI);
  EXPECT_EQ(sample.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(sample.count, 7);
  EXPECT_TRUE(sample.on);
  EXPECT_EQ(sample.title, "a: title");
  EXPECT_EQ(sample.place_mm, Vec3(1, -2, 3.5));
  EXPECT_DOUBLE_EQ(sample.tilt_rad.y(), M_PI / 2);
  EXPECT_EQ(sample.range->second, 0.2);
  EXPECT_EQ(sample.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(sample.pose.rotation.x(), 1.0);
  EXPECT_EQ(sample.pose.translation_mm, Vec3(1, 2, 3));
  EXPECT_EQ(sample.shade, Shade::dark);
  EXPECT_EQ(sample.extra->name, "e");
  ASSERT_EQ(sample.items.size(), 2u);
  EXPECT_DOUBLE_EQ(sample.items[0].angle_rad, M_PI / 2);
  EXPECT_EQ(sample.by_name.at("front").name, "f");
}

TEST(YamlReader, KeepsDefaultsOfAbsentKeys) {
  const Sample sample = read("count: 2\n");
  EXPECT_EQ(sample.length_mm, 1.0);
  EXPECT_EQ(sample.limit_mm, std::nullopt);
  EXPECT_EQ(sample.extra.has_value(), false);
}

TEST(YamlWriter, ReadsBackToTheSameBits) {
  Rng rng(1, 0, "yaml");
  for (int trial = 0; trial < 200; ++trial) {
    Sample sample;
    sample.length_mm = std::exp(20.0 * rng.normal());
    if (trial % 2) sample.limit_mm = rng.normal();
    // What a file can say: degrees, here with up to 17 digits.
    sample.angle_rad = radians_from_degrees(100.0 * rng.normal());
    sample.tilt_rad = Vec3(radians_from_degrees(0.2), radians_from_degrees(rng.normal()), -0.0);
    sample.seed = rng.bits();
    sample.title = trial % 3 ? "null" : "\"quoted\": #text\n'x' \xc3\xa4";
    sample.place_mm = rng.normal_vector();
    sample.range = {rng.uniform(), 2.0};
    sample.names = {"true", "- dash", "0x10"};
    sample.pose.rotation = rotation_from_vector(rng.normal_vector());
    sample.pose.translation_mm = 1e6 * rng.normal_vector();
    sample.shade = Shade::dark;
    sample.items = {{"a", radians_from_degrees(33.3)}, {"b", 0.0}};
    sample.by_name = {{"front view", {"c", 0.0}}};
    const std::string text = yaml_text([&](YamlFields& io) { fields(io, sample); });
    Sample back = read(text);
    EXPECT_EQ(back.length_mm, sample.length_mm);
    EXPECT_EQ(back.limit_mm, sample.limit_mm);
    EXPECT_EQ(back.angle_rad, sample.angle_rad) << text;
    EXPECT_EQ(back.tilt_rad, sample.tilt_rad);
    EXPECT_EQ(back.title, sample.title);
    EXPECT_EQ(back.names, sample.names);
    EXPECT_EQ(back.pose.rotation.coeffs(), sample.pose.rotation.coeffs());
    EXPECT_EQ(back.pose.translation_mm, sample.pose.translation_mm);
    EXPECT_EQ(back.items[0].angle_rad, sample.items[0].angle_rad);
    // And everything that is not compared above.
    EXPECT_EQ(yaml_text([&](YamlFields& io) { fields(io, back); }), text);
  }
}

TEST(YamlWriter, KeepsRoundDegreesRound) {
  for (const double degrees : {0.1, 0.2, 0.3, 11.5, 45.0, 60.0, 179.99, -0.05})
    EXPECT_EQ(degrees_text(radians_from_degrees(degrees)), number_text(degrees));
}

struct Defect {
  std::string text;
  std::string message;
};

class YamlDefect : public testing::TestWithParam<Defect> {};

TEST_P(YamlDefect, IsNamedWithFileLineValueAndConstraint) {
  EXPECT_EQ(error_of(GetParam().text), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    All, YamlDefect,
    testing::Values(
        Defect{"", "sample.yaml: is empty"}, Defect{"# only a comment\n", "sample.yaml: is empty"},
        Defect{"- a\n", "sample.yaml:1: holds a list, must be a map of keys"},
        Defect{"count: 1\ncuont: 2\n",
               "sample.yaml:2: unknown key \"cuont\", did you mean \"count\"?; valid keys are angle_deg, "
               "by_name, count, extra, items, length_mm, limit_mm, names, on, place_mm, pose, range, seed, "
               "shade, tilt_deg, title"},
        Defect{"extra:\n  name: x\n  temperature: 20\n",
               "sample.yaml:3: unknown key \"temperature\" in extra; valid keys are angle_deg, name"},
        Defect{"items:\n- {name: x}\n- {nam: x}\n",
               "sample.yaml:3: unknown key \"nam\" in items[1], did you mean \"name\"?; valid keys are "
               "angle_deg, name"},
        Defect{"\nextra: {angle_deg: 3}\n", "sample.yaml:2: extra.name is missing"},
        Defect{"count: 1\n\ncount: 2\n", "sample.yaml:3: key \"count\" is given twice, first in line 1"},
        Defect{"length_mm: -1\n", "sample.yaml:1: length_mm is -1, must be above 0"},
        Defect{"length_mm: .nan\n", "sample.yaml:1: length_mm is \".nan\", must be a finite number"},
        Defect{"length_mm: nan\n", "sample.yaml:1: length_mm is \"nan\", must be a finite number"},
        Defect{"length_mm: 1e999\n", "sample.yaml:1: length_mm is \"1e999\", must be a finite number"},
        Defect{"length_mm: 2 mm\n", "sample.yaml:1: length_mm is \"2 mm\", must be a finite number"},
        Defect{"length_mm: [1]\n", "sample.yaml:1: length_mm is a list, must be a single value"},
        Defect{"length_mm:\n", "sample.yaml:1: length_mm is empty, must be a single value"},
        Defect{"count: 11\n", "sample.yaml:1: count is 11, must be a whole number from 1 to 10"},
        Defect{"count: 2.5\n", "sample.yaml:1: count is 2.5, must be a whole number from 1 to 10"},
        Defect{"seed: -1\n",
               "sample.yaml:1: seed is -1, must be a whole number from 0 to 18446744073709551615"},
        Defect{"on: yes\n", "sample.yaml:1: on is \"yes\", must be true or false"},
        Defect{"place_mm: [1, 2]\n", "sample.yaml:1: place_mm has 2 numbers, must have 3"},
        Defect{"place_mm: 3\n", "sample.yaml:1: place_mm is a single value, must be a list"},
        Defect{"place_mm: [1, 2, inf]\n", "sample.yaml:1: place_mm is \"inf\", must be a finite number"},
        Defect{"names: [[a]]\n", "sample.yaml:1: an item of names is a list, must be a single value"},
        Defect{"range: [2, 1]\n", "sample.yaml:1: range is [2, 1], must be [low, high]"},
        Defect{"pose: {rotation_wxyz: [1, 1, 0, 0]}\n",
               "sample.yaml:1: pose.rotation_wxyz has length 1.4142135623730951, must be a unit quaternion"},
        Defect{"shade: drak\n",
               "sample.yaml:1: shade is \"drak\", did you mean \"dark\"? It must be one of light, dark"},
        Defect{"items: {name: x}\n", "sample.yaml:1: items is a map, must be a list"},
        Defect{"items: [x]\n", "sample.yaml:1: items[0] is a single value, must be a map"},
        Defect{"extra: {name: x, angle_deg: 181}\n",
               "sample.yaml:1: extra.angle_deg is 181, must be from -180 to 180"},
        Defect{"title: &a x\nnames: [*a]\n", "sample.yaml:1: anchors (&) and aliases (*) are not supported"},
        Defect{"title: !!python/object x\n",
               "sample.yaml:1: tag \"tag:yaml.org,2002:python/object\" is not supported"},
        Defect{"? [a]\n: b\n", "sample.yaml:1: a key must be a single word"},
        Defect{"count: 1\n---\ncount: 2\n", "sample.yaml:3: a second document begins, must be one"},
        Defect{std::string("count: 1\0", 9), "sample.yaml: is not text"}));

TEST(YamlReader, NamesTheLineOfBrokenSyntax) {
  EXPECT_EQ(error_of("count: 1\n  seed: [1\n"), "sample.yaml:2: not valid YAML: illegal map value");
  EXPECT_EQ(error_of("\ntitle: [1, 2\n"), "sample.yaml:3: not valid YAML: end of sequence flow not found");
  EXPECT_EQ(error_of("count: }\n"), "sample.yaml:1: not valid YAML: illegal flow end");
}

TEST(YamlReader, AttachesTheLineToAComplaintOfALibrary) {
  const auto complain_about = [](const std::string& complaint) {
    try {
      read_yaml_text("a: {\n  tolerance_deg: 1,\n  b: {\n    depth: 2 } }\n", "sample.yaml",
                     [&](YamlFields& io) {
                       io.map("a", [&](YamlFields& a) {
                         double unused = 0.0;
                         a.angle("tolerance_deg", unused);
                         a.map("b", [&](YamlFields& b) { b.number("depth", unused); });
                         a.check([&] { throw InputError(complaint); });
                       });
                     });
    } catch (const InputError& failure) {
      return std::string(failure.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(complain_about("tolerance_rad is 1, must be 2"),
            "sample.yaml:2: a.tolerance_rad is 1, must be 2");
  EXPECT_EQ(complain_about("lens x: tolerance_rad is 1"), "sample.yaml:2: lens x: a.tolerance_rad is 1");
  EXPECT_EQ(complain_about("b.depth is 2"), "sample.yaml:4: a.b.depth is 2");
  EXPECT_EQ(complain_about("b.width is 2"), "sample.yaml:3: a.b.width is 2");
  EXPECT_EQ(complain_about("the whole is odd"), "sample.yaml:1: the whole is odd");
  EXPECT_EQ(complain_about("the b is odd"), "sample.yaml:3: the b is odd");  // a word, not surely the key
}

TEST(YamlReader, RefusesInputMadeToExhaustMemoryOrStack) {
  std::string laughs = "a: &a [x, x]\n";
  for (char name = 'b'; name < 'z'; ++name)
    laughs += std::string(1, name) + ": &" + name + " [*" + static_cast<char>(name - 1) + "]\n";
  EXPECT_NE(error_of(laughs).find("anchors"), std::string::npos);
  const std::string nested = "names: " + std::string(100, '[') + std::string(100, ']');
  EXPECT_NE(error_of(nested).find("nested deeper than 20"), std::string::npos);
  // Refused for one reason or another, and soon.
  EXPECT_NE(error_of("names: " + std::string(200'000, '[')), "no error");
  EXPECT_NE(error_of("x: " + std::string(200'000, '{')), "no error");
  std::string indented;
  for (int level = 0; level < 600; ++level) indented += std::string(level, ' ') + "a:\n";
  EXPECT_NE(error_of(indented).find("nested deeper than 20"), std::string::npos);
}

}  // namespace
}  // namespace trueblade
