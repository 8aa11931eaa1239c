#include "part/turbine_blade_parameters.h"

#include <cmath>

#include "part/require_parameter.h"

namespace trueblade {

namespace {

void require_sections(const TurbineBladeParameters& p) {
  const auto check = [](const char* chord_name, double chord, const char* thickness_name, double thickness) {
    require_within(chord_name, chord, 1.0, 1000.0);
    require_parameter(thickness > 0.0 && thickness <= 0.3 * chord, thickness_name, thickness,
                      fmt::format("above 0 and at most 0.3 of the chord, {:.3g}", 0.3 * chord));
  };
  check("root_chord_mm", p.root_chord_mm, "root_max_thickness_mm", p.root_max_thickness_mm);
  check("tip_chord_mm", p.tip_chord_mm, "tip_max_thickness_mm", p.tip_max_thickness_mm);
  const auto check_radius = [](const char* name, double radius, double thickness) {
    require_parameter(radius > 0.0 && radius < 0.5 * thickness, name, radius,
                      fmt::format("above 0 and below half the section's thickness, {:.3g}", 0.5 * thickness));
  };
  check_radius("root_leading_edge_radius_mm", p.root_leading_edge_radius_mm, p.root_max_thickness_mm);
  check_radius("root_trailing_edge_radius_mm", p.root_trailing_edge_radius_mm, p.root_max_thickness_mm);
  check_radius("tip_leading_edge_radius_mm", p.tip_leading_edge_radius_mm, p.tip_max_thickness_mm);
  check_radius("tip_trailing_edge_radius_mm", p.tip_trailing_edge_radius_mm, p.tip_max_thickness_mm);
  require_within("section_lift_coefficient", p.section_lift_coefficient, 0.0, 2.0);
  require_within("root_camber_factor", p.root_camber_factor, 0.0, 10.0);
  require_within("tip_camber_factor", p.tip_camber_factor, 0.0, 10.0);
  require_within("root_stagger_deg", p.root_stagger_deg, -80.0, 80.0);
  require_within("tip_stagger_deg", p.tip_stagger_deg, -80.0, 80.0);
  require_parameter(std::abs(p.tip_stagger_deg - p.root_stagger_deg) <= 90.0, "tip_stagger_deg",
                    p.tip_stagger_deg, "within 90 degrees of root_stagger_deg");
}

void require_root(const TurbineBladeParameters& p) {
  require_within("platform_length_mm", p.platform_length_mm, 1.0, 2000.0);
  require_within("platform_width_mm", p.platform_width_mm, 1.0, 2000.0);
  require_within("platform_thickness_mm", p.platform_thickness_mm, 0.1, 1000.0);
  require_parameter(p.root_length_mm > 0.0 && p.root_length_mm < p.platform_length_mm, "root_length_mm",
                    p.root_length_mm, "above 0 and below platform_length_mm");
  require_within("root_height_mm", p.root_height_mm, 0.1, 1000.0);
  require_parameter(p.root_neck_height_mm > 0.0 && p.root_neck_height_mm < p.root_height_mm,
                    "root_neck_height_mm", p.root_neck_height_mm, "above 0 and below root_height_mm");
  require_parameter(p.root_corner_radius_mm > 0.0, "root_corner_radius_mm", p.root_corner_radius_mm,
                    "above 0");
  require_parameter(p.root_neck_width_mm > 0.0 &&
                        p.root_neck_width_mm + 2.0 * p.root_corner_radius_mm < p.platform_width_mm,
                    "root_neck_width_mm", p.root_neck_width_mm,
                    "above 0 and leave room on the platform's underside for the corners");
  require_within("root_taper_deg", p.root_taper_deg, 0.0, 45.0);
  require_parameter(p.root_tooth_depth_mm > 0.0 && p.root_tooth_depth_mm < p.root_neck_width_mm,
                    "root_tooth_depth_mm", p.root_tooth_depth_mm, "above 0 and below root_neck_width_mm");
  require_within("root_teeth", p.root_teeth, 1, 6);
}

}  // namespace

void TurbineBladeParameters::validate() const {
  require_within("span_mm", span_mm, 1.0, 2000.0);
  require_sections(*this);
  require_parameter(fillet_radius_mm > 0.0 && fillet_radius_mm <= 0.25 * span_mm, "fillet_radius_mm",
                    fillet_radius_mm,
                    fmt::format("above 0 and at most a quarter of span_mm, {:.3g}", 0.25 * span_mm));
  require_root(*this);
  require_within("spanwise_patches", spanwise_patches, 1, 50);
  require_within("chordwise_patches", chordwise_patches, 1, 50);
}

int surface_count(const TurbineBladeParameters& p) {
  const int strips = 2 * p.chordwise_patches + 4;             // both sides, two halves of both edges
  const int airfoil = strips * (p.spanwise_patches + 1) + 1;  // with the fillet; tip
  const int platform = 6;
  const int root_side =
      3 + 6 * p.root_teeth;  // blend, neck, corner at the bottom; six per tooth with its valley
  return airfoil + platform + 2 * root_side + 1 + 2;  // bottom; both ends
}

}  // namespace trueblade
