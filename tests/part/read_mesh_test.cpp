// STL, OBJ and PLY parts: a cube of 10 mm in every format has 600 mm2 and 1000 mm3, exactly.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "geometry/random.h"
#include "part/part.h"
#include "part/part_info.h"
#include "part/write_mesh.h"
#include "tests/part/expect_input_error.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

PartOptions in(LengthUnit unit) {
  PartOptions options;
  options.unit = unit;
  return options;
}
const PartOptions kMillimetres = in(LengthUnit::millimetre);

// Outline of a unit cube's faces, counter-clockwise from outside, numbered from 1 as OBJ does.
const std::string kCubeNodes = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
const std::string kCubeObj = "# a cube\nmtllib x.mtl\n" + kCubeNodes +
                             "vn 0 0 1\ng bottom\nf 4 3 2 1\ng top\nf 5//1 6//1 7//1 8//1\no sides\n"
                             "f 1 2 6 5\nf 2/1 3/1 7/1 6/1\nf 3 4 8 7\nf -8 -4 -1 -5\n";

void expect_cube(const Part& part, double side_mm) {
  EXPECT_EQ(part.model.facet_count(), 12U);
  EXPECT_EQ(part.model.node_count(), 8U);
  EXPECT_TRUE(part.report.closed);
  EXPECT_EQ(part.report.shells, 1U);
  // Sums of twelve products of exactly representable numbers: no rounding.
  EXPECT_EQ(part.model.area_mm2(), 6 * side_mm * side_mm);
  EXPECT_NEAR(part.model.volume_mm3(), std::pow(side_mm, 3), 4e-15 * std::pow(side_mm, 3));
}

TEST(ReadObj, PolygonsNegativeNumbersAndGroups) {
  const TemporaryFolder folder;
  const Part part = read_part(folder.write("cube.obj", kCubeObj), in(LengthUnit::centimetre));
  expect_cube(part, 10.0);
  ASSERT_EQ(part.surfaces.size(), 3U);
  EXPECT_EQ(part.surfaces[0].name, "bottom");
  EXPECT_EQ(part.surfaces[1].name, "top");
  EXPECT_EQ(part.surfaces[2].name, "sides");
  EXPECT_EQ(part.surfaces[2].facets, 8U);
  EXPECT_EQ(part.surfaces[2].area_mm2, 400.0);
}

TEST(ReadObj, ErrorsNameTheLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& bytes) { read_part(folder.write("x.obj", bytes), kMillimetres); };
  EXPECT_INPUT_ERROR(read(kCubeNodes + "f 1 2 9\n"), "x.obj:9: vertex number \"9\"");
  EXPECT_INPUT_ERROR(read(kCubeNodes + "f 1 2 0\n"), "x.obj:9: vertex number \"0\"");
  EXPECT_INPUT_ERROR(read(kCubeNodes + "f 1 2 -9\n"), "x.obj:9: vertex number \"-9\"");
  EXPECT_INPUT_ERROR(read(kCubeNodes + "f 1 2 99999999999999999999\n"), "x.obj:9:");
  EXPECT_INPUT_ERROR(read(kCubeNodes + "f 1 2\n"), "x.obj:9: the face has 2 corners");
  EXPECT_INPUT_ERROR(read("v 0 nan 0\n"), "x.obj:1: a coordinate is not finite");
  EXPECT_INPUT_ERROR(read("v 0 1e999 0\n"), "x.obj:1: coordinate \"1e999\"");
  EXPECT_INPUT_ERROR(read("ISO-10303-21;\n"), "x.obj:1: keyword");
  EXPECT_INPUT_ERROR(read(kCubeNodes), "has no facets");
}

TEST(WriteMesh, EveryFormatReadsBackAsTheSameCube) {
  const TemporaryFolder folder;
  const Part cube = read_part(folder.write("cube.obj", kCubeObj), in(LengthUnit::centimetre));
  for (const char* name : {"copy.ply", "copy.stl", "copy.obj"}) {
    write_mesh(cube, folder / name);
    expect_cube(read_part(folder / name, kMillimetres), 10.0);
  }
  // Our PLY says its unit and keeps the surfaces; OBJ keeps their names.
  const Part from_ply = read_part(folder / "copy.ply", {});
  EXPECT_EQ(from_ply.surfaces.size(), 3U);
  EXPECT_EQ(from_ply.surfaces[2].facets, 8U);
  EXPECT_EQ(read_part(folder / "copy.obj", kMillimetres).surfaces[2].name, "sides");
  EXPECT_INPUT_ERROR(read_part(folder / "copy.ply", in(LengthUnit::inch)),
                     "is not the one that the file states");
  EXPECT_INPUT_ERROR(write_mesh(cube, folder / "copy.xyz"), "no mesh format");
}

TEST(WriteMesh, PlyKeepsEveryBit) {
  const TemporaryFolder folder;
  Rng random(3, 0, "nodes");
  std::string obj;
  for (int i = 0; i < 30; ++i) {
    obj += "v";
    for (int axis = 0; axis < 3; ++axis) obj += " " + std::to_string(100 * random.normal());
    obj += "\n";
    if (i >= 2) obj += "f -1 -2 -3\n";
  }
  const Part part = read_part(folder.write("x.obj", obj), in(LengthUnit::inch));
  write_mesh(part, folder / "x.ply");
  const Part copy = read_part(folder / "x.ply", {});
  ASSERT_EQ(copy.model.node_count(), part.model.node_count());
  for (std::uint32_t node = 0; node < part.model.node_count(); ++node)
    EXPECT_EQ(copy.model.node_mm(node), part.model.node_mm(node));
}

TEST(PartInfo, SaysWhatTheCubeIs) {
  const TemporaryFolder folder;
  const Part cube = read_part(folder.write("cube.obj", kCubeObj), in(LengthUnit::centimetre));
  const PartInfo info = part_info(cube);
  EXPECT_EQ(info.upper_corner_mm, Vec3(10, 10, 10));
  EXPECT_TRUE(info.volume_mm3.has_value());
  EXPECT_FALSE(info.chord_error_mm.has_value());
  const std::string text = to_text(info);
  EXPECT_NE(text.find("surfaces      3 (3 facets)"), std::string::npos) << text;
  EXPECT_NE(text.find("defects       none"), std::string::npos) << text;
}

TEST(PartInfo, AnOpenCubeHasNoVolumeAndOneHole) {
  const TemporaryFolder folder;
  std::string obj = kCubeObj;
  obj.erase(obj.find("f 4 3 2 1"), 10);
  const PartInfo info = part_info(read_part(folder.write("open.obj", obj), kMillimetres));
  EXPECT_FALSE(info.volume_mm3.has_value());
  EXPECT_EQ(info.report.holes, 1U);
  EXPECT_EQ(info.report.boundary_edges, 4U);
  EXPECT_NE(to_text(info).find("1 holes"), std::string::npos);
}

const std::string kTriangle =
    "solid wing one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 3 0 0\n   vertex 0 4 0\n"
    "  endloop\n endfacet\nendsolid wing one\n";

TEST(ReadStl, EverySolidOfAnAsciiFileIsASurface) {
  const TemporaryFolder folder;
  std::string second = kTriangle;
  second.replace(second.find("wing"), 4, "root").replace(second.find("0 4 0"), 5, "0 0 4");
  const Part part = read_part(folder.write("x.stl", kTriangle + "SOLID" + second.substr(5)), kMillimetres);
  ASSERT_EQ(part.surfaces.size(), 2U);
  EXPECT_EQ(part.surfaces[0].name, "wing");
  EXPECT_EQ(part.surfaces[1].area_mm2, 6.0);
}

// One triangle, in binary.
std::string binary_stl(const std::string& header, std::uint32_t count, float first_coordinate) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const auto put = [&bytes](std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
  };
  put(count);
  for (const float value : {0.f, 0.f, 1.f, first_coordinate, 0.f, 0.f, 3.f, 0.f, 0.f, 0.f, 4.f, 0.f})
    put(std::bit_cast<std::uint32_t>(value));
  return bytes + std::string(2, '\0');
}

TEST(ReadStl, ABinaryFileMayStartWithSolid) {
  const TemporaryFolder folder;
  for (const char* header : {"solid by another system", "binary"})
    EXPECT_EQ(read_part(folder.write("x.stl", binary_stl(header, 1, 0)), kMillimetres).model.area_mm2(), 6.0);
}

TEST(ReadStl, BadFilesSayWhy) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& bytes) { read_part(folder.write("x.stl", bytes), kMillimetres); };
  EXPECT_INPUT_ERROR(read(binary_stl("x", 2, 0)), "asks for 184 bytes, but it has 134");
  EXPECT_INPUT_ERROR(read(binary_stl("x", 4000000000U, 0)), "but it has 134");
  EXPECT_INPUT_ERROR(read(binary_stl("x", 1, std::numeric_limits<float>::quiet_NaN())),
                     "facet 0: a coordinate is not finite (at byte 84)");
  EXPECT_INPUT_ERROR(read(binary_stl("x", 0, 0).substr(0, 84)), "has no facets");
  EXPECT_INPUT_ERROR(read("solid x\nendsolid x\n"), "has no facets");
  EXPECT_INPUT_ERROR(read(kTriangle.substr(0, kTriangle.find("   vertex 3"))), "is truncated");
  std::string bytes = kTriangle;
  EXPECT_INPUT_ERROR(read(bytes.replace(bytes.find("3 0 0"), 5, "3 0 x")), "x.stl:5: coordinate \"x\"");
  bytes = kTriangle;
  EXPECT_INPUT_ERROR(read(bytes.replace(bytes.find("3 0 0"), 5, "inf 0 0")),
                     "x.stl:5: a coordinate is not finite");
  bytes = kTriangle;
  EXPECT_INPUT_ERROR(read(bytes.replace(bytes.find("endloop"), 7, "vertex ")),
                     "x.stl:7: \"endloop\" must stand");
  EXPECT_INPUT_ERROR(read("not a mesh at all\n"), "x.stl:1: \"solid\" must stand here");
  for (std::size_t size = 1; size + 12 < kTriangle.size(); ++size)
    EXPECT_THROW(read(kTriangle.substr(0, size)), InputError) << size;
}

TEST(ReadPart, UnitEndingAndFileAreChecked) {
  const TemporaryFolder folder;
  EXPECT_INPUT_ERROR(read_part(folder.write("x.stl", kTriangle), {}), "unit is missing");
  EXPECT_INPUT_ERROR(read_part(folder.write("x.step", "x"), kMillimetres), "unit must not be given");
  EXPECT_INPUT_ERROR(read_part(folder.write("x.doc", "x"), kMillimetres), "is no part format");
  EXPECT_INPUT_ERROR(read_part(folder / "missing.stl", kMillimetres), "no such file");
  EXPECT_INPUT_ERROR(read_part(folder.write("x.obj", ""), kMillimetres), "is empty");
  std::filesystem::create_directory(folder / "folder.stl");
  EXPECT_INPUT_ERROR(read_part(folder / "folder.stl", kMillimetres), "is not a regular file");
  EXPECT_INPUT_ERROR(parse_length_unit("ell"), "mm, cm, m, in, um");
  EXPECT_EQ(read_part(folder.write("x.stl", kTriangle), in(LengthUnit::inch)).model.upper_corner_mm(),
            Vec3(3 * 25.4, 4 * 25.4, 0));
}

TEST(ReadPly, FacesAreChecked) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0\n";
  const auto read = [&](const std::string& rest) {
    return read_part(folder.write("x.ply", header + rest), kMillimetres);
  };
  EXPECT_EQ(read("0 4 0\n3 0 1 2\n").model.area_mm2(), 6.0);
  EXPECT_INPUT_ERROR(read("0 nan 0\n3 0 1 2\n"), "x.ply:12: a coordinate is not finite");
  EXPECT_INPUT_ERROR(read("0 4 0\n3 0 1 3\n"), "x.ply:13: vertex number 3");
  EXPECT_INPUT_ERROR(read("0 4 0\n3 0 1 -1\n"), "x.ply:13: vertex number -1");
  EXPECT_INPUT_ERROR(read("0 4 0\n2 0 1\n"), "x.ply:13: the face has 2 corners");
}

}  // namespace
}  // namespace trueblade
