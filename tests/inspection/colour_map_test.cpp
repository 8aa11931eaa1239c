// Covers: ends, middle and sides of both maps, clamping, NaN, the accessible map's lightness, the scale's
// rounding.
#include "inspection/colour_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

TEST(ColourMap, BlueInsideGreenNominalRedOutside) {
  const ColourMap map = ColourMap::blue_green_red;
  EXPECT_EQ(colour_of(map, -0.1, 0.1), (Colour{0, 0, 255}));
  EXPECT_EQ(colour_of(map, 0.0, 0.1), (Colour{0, 255, 0}));
  EXPECT_EQ(colour_of(map, 0.1, 0.1), (Colour{255, 0, 0}));
  EXPECT_EQ(colour_of(map, 5.0, 0.1), (Colour{255, 0, 0}));
  EXPECT_EQ(colour_of(map, -5.0, 0.1), (Colour{0, 0, 255}));
  EXPECT_EQ(colour_of(map, std::nan(""), 0.1), kOutlierColour);
}

TEST(ColourMap, NoColourIsTheOutliersBlack) {
  for (const ColourMap map : {ColourMap::blue_green_red, ColourMap::blue_white_orange}) {
    for (int i = -100; i <= 100; ++i) {
      const Colour c = colour_of(map, i / 100.0, 1.0);
      EXPECT_GT(c.red + c.green + c.blue, 150) << to_string(map) << " at " << i;
    }
  }
}

// Relative luminance of sRGB (IEC 61966-2-1).
double luminance(Colour c) {
  const auto linear = [](std::uint8_t v) {
    const double s = v / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
}

TEST(ColourMap, AccessibleMapDarkensToBothSides) {
  for (int i = 1; i <= 100; ++i) {
    for (const double side : {-1.0, 1.0}) {
      EXPECT_LE(luminance(colour_of(ColourMap::blue_white_orange, side * i / 100.0, 1.0)),
                luminance(colour_of(ColourMap::blue_white_orange, side * (i - 1) / 100.0, 1.0)));
    }
    // Blue stays blue and orange stays orange: the sides are told apart without red against green.
    const Colour inside = colour_of(ColourMap::blue_white_orange, -i / 100.0, 1.0);
    const Colour outside = colour_of(ColourMap::blue_white_orange, i / 100.0, 1.0);
    EXPECT_LT(inside.red - inside.blue, outside.red - outside.blue);
  }
}

TEST(ColourMap, NamesReadBack) {
  for (const ColourMap map : {ColourMap::blue_green_red, ColourMap::blue_white_orange}) {
    EXPECT_EQ(parse_colour_map(to_string(map)), map);
  }
  EXPECT_THROW(parse_colour_map("rainbow"), InputError);
}

TEST(ColourLimit, IsRoundAndHoldsThreeTimesTheRms) {
  EXPECT_DOUBLE_EQ(rounded_colour_limit_mm(0.001), 0.005);
  EXPECT_DOUBLE_EQ(rounded_colour_limit_mm(0.054), 0.2);
  EXPECT_DOUBLE_EQ(rounded_colour_limit_mm(0.3), 1.0);
  EXPECT_DOUBLE_EQ(rounded_colour_limit_mm(2.0), 10.0);
  for (double rms = 1e-6; rms < 1e3; rms *= 1.37) {
    EXPECT_GE(rounded_colour_limit_mm(rms), 3.0 * rms);
    EXPECT_LE(rounded_colour_limit_mm(rms), 7.5 * rms * (1.0 + 1e-12));  // the widest gap, from 2 to 5
  }
  EXPECT_EQ(rounded_colour_limit_mm(0.0), 0.001);
  EXPECT_EQ(rounded_colour_limit_mm(std::nan("")), 0.001);
}

}  // namespace
}  // namespace trueblade
