// What the demonstration sheet part is made from.
#pragma once

namespace trueblade {

// A pressed bracket: a crowned, twisted panel between two flanges, with two beads and a cup raised in the
// panel and darts pressed into both bends. Lengths across the part (`front` to `back`) are measured along the
// sheet.
struct FormedPartParameters {
  double length_mm = 120.0;
  double thickness_mm = 1.2;
  double front_flange_mm = 11.0;
  double panel_mm = 49.0;
  double back_flange_mm = 10.0;
  double front_bend_deg = 62.0;  // in the middle of the part
  double back_bend_deg = 48.0;
  double bend_twist_deg =
      9.0;  // from the middle to either end: the front bend opens while the back bend closes
  double bend_radius_mm = 6.0;        // smallest, of the outer side
  double lengthwise_crown_mm = 4.0;   // by which the ends lie lower than the middle
  double crosswise_crown_deg = 16.0;  // turn of the panel from its front to its back
  double bead_height_mm = 2.4;
  double dart_depth_mm = 2.0;
  double corner_radius_mm = 4.0;  // of the sheet's four corners
  double hole_diameter_mm = 7.0;  // one in the cup, one at each end of the panel
  int lengthwise_patches = 9;

  // Throws InputError naming the field, its value and the constraint.
  void validate() const;
};

// Number of CAD surfaces of the part with these parameters: 165 with the defaults.
int surface_count(const FormedPartParameters& parameters);

}  // namespace trueblade
