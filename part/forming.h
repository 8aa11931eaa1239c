// The outer side of the formed part as a function: what the press makes of the flat sheet.
#pragma once

#include <vector>

#include "geometry/vector.h"
#include "part/formed_part_parameters.h"

namespace trueblade {

// Widths of the ramps of beads and darts.
inline constexpr double kRampToPanel = 0.12;
inline constexpr double kRampToBend = 0.4;

// Length of sheet that a bend takes at the end of the part where it turns most.
double bend_width_mm(const FormedPartParameters& parameters, double bend_deg);

class Forming {
 public:
  // Precondition: the parameters are valid.
  explicit Forming(const FormedPartParameters& parameters);

  // `across` in mm along the sheet from the middle of the panel, from across_borders().front() to back();
  // `along` from -1 to 1 over the length.
  Vec3 point(double across, double along) const;
  Vec3 normal(double across, double along) const;  // unit, out of the sheet's outer side

  // Where the sheet's regions meet: front flange, front bend, three parts of the panel, back bend, back
  // flange.
  const std::vector<double>& across_borders() const { return across_borders_; }

  // Centres of the holes, (across, along).
  std::vector<Vec2> hole_centres() const;

 private:
  // Raised above (or pressed below) the base surface: a rounded rectangle with a flat top and a smooth ramp.
  struct Bump {
    double across, along_mm;               // centre
    double half_across_mm, half_along_mm;  // of the rectangle that the top and the ramp run around
    double top_mm, ramp_mm;                // widths
    double height_mm;
  };
  struct Heading {
    double sine, cosine;
  };
  Heading heading(double across, double along) const;
  double height(double across, double along) const;

  FormedPartParameters parameters_;
  double front_bend_, back_bend_;  // rad
  double front_bend_width_, back_bend_width_;
  std::vector<double> across_borders_;
  std::vector<Bump> bumps_;
};

}  // namespace trueblade
