// Colours of signed deviations: one map, used by the pictures, the point clouds and the HTML report.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace trueblade {

struct Colour {  // sRGB
  std::uint8_t red, green, blue;
  bool operator==(const Colour&) const = default;
};

// Outliers are black and belong to no map (paper, Fig. 8).
inline constexpr Colour kOutlierColour{0, 0, 0};

enum class ColourMap {
  blue_green_red,  // the paper's, and what inspection software shows: blue inside, green nominal, red outside
  blue_white_orange  // diverging and readable with red-green colour blindness: lightness falls to both sides
};
std::string to_string(ColourMap map);
ColourMap parse_colour_map(const std::string& name);  // throws InputError naming the maps

// Colour of a deviation on the scale -limit_mm (blue) to +limit_mm (red or orange); beyond it the end
// colours, kOutlierColour for NaN. Precondition: limit_mm > 0.
Colour colour_of(ColourMap map, double deviation_mm, double limit_mm);

// The anchors between which a map is linear, from -limit to +limit in equal steps, for writers that build
// their own scale (the HTML report).
inline constexpr std::size_t kColourAnchors = 9;
const std::array<Colour, kColourAnchors>& colour_anchors(ColourMap map);

// The scale of a colour bar when none is asked for: the smallest of 1, 2 or 5 times a power of ten that is
// not below three times the RMS. 0.001 mm when the RMS is not a positive number.
double rounded_colour_limit_mm(double rms_mm);

}  // namespace trueblade
