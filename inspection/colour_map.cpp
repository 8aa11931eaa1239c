#include "inspection/colour_map.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

using Anchors = std::array<Colour, kColourAnchors>;

// Blue, cyan, green, yellow, red with their midpoints.
constexpr Anchors kBlueGreenRed{{{0, 0, 255},
                                 {0, 128, 255},
                                 {0, 255, 255},
                                 {0, 255, 128},
                                 {0, 255, 0},
                                 {128, 255, 0},
                                 {255, 255, 0},
                                 {255, 128, 0},
                                 {255, 0, 0}}};

// Steps of near-equal lightness on both sides of a light grey, which stays visible on white paper.
constexpr Anchors kBlueWhiteOrange{{{10, 47, 122},
                                    {33, 96, 168},
                                    {86, 147, 204},
                                    {160, 196, 228},
                                    {238, 238, 234},
                                    {250, 196, 132},
                                    {238, 144, 62},
                                    {199, 92, 17},
                                    {134, 48, 2}}};

std::uint8_t between(std::uint8_t a, std::uint8_t b, double t) {
  return static_cast<std::uint8_t>(std::lround(a + t * (b - a)));
}

}  // namespace

std::string to_string(ColourMap map) {
  return map == ColourMap::blue_green_red ? "blue_green_red" : "blue_white_orange";
}

ColourMap parse_colour_map(const std::string& name) {
  for (const ColourMap map : {ColourMap::blue_green_red, ColourMap::blue_white_orange}) {
    if (name == to_string(map)) return map;
  }
  throw InputError("colour map is '" + name + "', must be blue_green_red or blue_white_orange");
}

const Anchors& colour_anchors(ColourMap map) {
  return map == ColourMap::blue_green_red ? kBlueGreenRed : kBlueWhiteOrange;
}

Colour colour_of(ColourMap map, double deviation_mm, double limit_mm) {
  if (std::isnan(deviation_mm)) return kOutlierColour;
  const Anchors& anchors = colour_anchors(map);
  const double position = 0.5 * (std::clamp(deviation_mm / limit_mm, -1.0, 1.0) + 1.0) * (kColourAnchors - 1);
  const auto lower = std::min(static_cast<std::size_t>(position), kColourAnchors - 2);
  const double t = position - static_cast<double>(lower);
  const Colour &a = anchors[lower], &b = anchors[lower + 1];
  return {between(a.red, b.red, t), between(a.green, b.green, t), between(a.blue, b.blue, t)};
}

double rounded_colour_limit_mm(double rms_mm) {
  const double least = 3.0 * rms_mm;
  if (!(least > 0.0) || !std::isfinite(least)) return 0.001;
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (least <= step * decade) return step * decade;
  }
  return 10.0 * decade;
}

}  // namespace trueblade
