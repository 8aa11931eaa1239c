// What the demonstration blade is made from.
#pragma once

#include <string>

namespace trueblade {

// "root" is the section at z = 0 as if there were no fillet, "tip" the one at z = span_mm. In between, every
// number changes linearly with z.
struct TurbineBladeParameters {
  std::string section_file;               // Selig .dat; empty: the NACA 65 series on the mean line below
  double section_lift_coefficient = 1.2;  // design lift coefficient of the NACA 65 series' mean line

  double span_mm = 68.0;
  double root_chord_mm = 36.0;
  double tip_chord_mm = 29.0;
  double root_max_thickness_mm = 3.6;
  double tip_max_thickness_mm = 2.0;
  double root_leading_edge_radius_mm = 0.45;
  double tip_leading_edge_radius_mm = 0.25;
  double root_trailing_edge_radius_mm = 0.35;
  double tip_trailing_edge_radius_mm = 0.2;
  double root_camber_factor = 1.0;  // on the height of the section's own mean line
  double tip_camber_factor = 0.6;
  double root_stagger_deg = 14.0;  // of the chord line against x, about +z
  double tip_stagger_deg = 40.0;
  double fillet_radius_mm = 3.0;  // between airfoil and platform

  double platform_length_mm = 46.0;  // along x
  double platform_width_mm = 26.0;   // along y
  double platform_thickness_mm = 5.0;

  double root_length_mm = 40.0;  // along x; the platform overhangs it at both ends
  double root_height_mm = 27.0;  // from the platform's underside to the root's bottom
  double root_neck_width_mm = 16.0;
  double root_neck_height_mm = 5.0;
  double root_taper_deg = 14.0;        // of the valleys' line against z, each side
  double root_tooth_depth_mm = 1.9;    // from the valleys' line to the teeth's
  double root_corner_radius_mm = 1.0;  // of every rounded corner of the fir tree
  int root_teeth = 3;                  // per side

  int spanwise_patches = 4;   // of the airfoil
  int chordwise_patches = 3;  // of each side, between the edges

  // Throws InputError naming the field, its value and the constraint.
  void validate() const;
};

// Number of CAD surfaces of the blade with these parameters: 102 with the defaults.
int surface_count(const TurbineBladeParameters& parameters);

}  // namespace trueblade
