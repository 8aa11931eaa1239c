// Both demonstration parts as the CAD kernel sees them: valid, closed, oriented outward, the same every time,
// and unchanged by the way through a STEP file.
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>

#include <algorithm>

#include "part/formed_part_shape.h"
#include "part/turbine_blade_shape.h"
#include "part/write_step_shape.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

double volume_mm3(const CadShape& cad) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(cad.shape, properties);
  return properties.Mass();
}

void expect_valid_solid(const CadShape& cad, std::size_t faces) {
  EXPECT_EQ(cad.faces.size(), faces);
  EXPECT_EQ(cad.names.size(), faces);
  EXPECT_TRUE(BRepCheck_Analyzer(cad.shape).IsValid());
  int solids = 0, shells = 0;
  for (TopExp_Explorer each(cad.shape, TopAbs_SOLID); each.More(); each.Next()) ++solids;
  for (TopExp_Explorer each(cad.shape, TopAbs_SHELL); each.More(); each.Next(), ++shells)
    EXPECT_TRUE(BRep_Tool::IsClosed(each.Current()));
  EXPECT_EQ(solids, 1);
  EXPECT_EQ(shells, 1);
  EXPECT_GT(volume_mm3(cad), 0.0);
}

template <typename Parameters>
void expect_valid_repeatable_part(CadShape (*build)(const Parameters&), std::size_t faces) {
  const CadShape built = build({}), again = build({});
  expect_valid_solid(built, faces);

  const TemporaryFolder folder;
  write_step_shape(built, "part", folder / "part.step");
  write_step_shape(again, "part", folder / "again.step");
  // No EXPECT_EQ: its account of the difference of two such files takes all memory.
  EXPECT_TRUE(bytes_of(folder / "part.step") == bytes_of(folder / "again.step"));

  CadShape read = read_step_shape(folder / "part.step", 1e-3);
  expect_valid_solid(read, faces);
  // STEP prints 15 digits: 1e-13 mm on every pole; quadrature over faces whose edges were made anew adds
  // 1e-9.
  EXPECT_NEAR(volume_mm3(read) / volume_mm3(built), 1.0, 1e-8);
  std::vector<std::string> names = built.names;
  std::sort(names.begin(), names.end());
  std::sort(read.names.begin(), read.names.end());
  EXPECT_EQ(read.names, names);
}

TEST(CadValidity, TurbineBlade) {
  expect_valid_repeatable_part(build_turbine_blade, 102);
}

TEST(CadValidity, FormedPart) {
  expect_valid_repeatable_part(build_formed_part, 165);
}

}  // namespace
}  // namespace trueblade
