// STEP and IGES files of shapes with closed-form area, volume and distance. Plain data, so that tests which
// use the facet model need not include OpenCASCADE.
#pragma once

#include <filesystem>
#include <string>

namespace trueblade {

enum class TestShape {
  box,           // 10 x 20 x 30 mm from the origin
  sphere,        // radius 8, centre (1, 2, 3)
  cylinder,      // radius 5, height 12, along z from the origin
  torus,         // radii 10 and 3, about z, centre at the origin
  spline_patch,  // an open sheet, z = 3 sin(x / 10) cos(y / 8) interpolated over [0, 40] x [0, 30]
  filleted_box,  // the box with all edges rounded with radius 2
  two_boxes,     // the box and a copy moved by 50 mm along x
  wire           // an edge: no surface
};

// `unit` is the one that the file is written in: "MM" or "INCH". The ending decides the format.
void write_test_shape(TestShape shape, const std::filesystem::path& file, const std::string& unit = "MM");

}  // namespace trueblade
