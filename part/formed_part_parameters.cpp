#include "part/formed_part_parameters.h"

#include <algorithm>

#include "part/forming.h"
#include "part/require_parameter.h"

namespace trueblade {

void FormedPartParameters::validate() const {
  require_within("length_mm", length_mm, 10.0, 1000.0);
  require_within("panel_mm", panel_mm, 10.0, 1000.0);
  require_within("thickness_mm", thickness_mm, 0.1, 5.0);
  require_within("front_flange_mm", front_flange_mm, 1.0, 100.0);
  require_within("back_flange_mm", back_flange_mm, 1.0, 100.0);
  require_within("bend_twist_deg", bend_twist_deg, 0.0, 30.0);
  const auto require_bend = [&](const char* name, double angle_deg) {
    require_parameter(
        angle_deg >= bend_twist_deg + 5.0 && angle_deg + bend_twist_deg <= 90.0, name, angle_deg,
        fmt::format("between {} and {}, so that bend_twist_deg leaves it between 5 and 90 degrees",
                    bend_twist_deg + 5.0, 90.0 - bend_twist_deg));
  };
  require_bend("front_bend_deg", front_bend_deg);
  require_bend("back_bend_deg", back_bend_deg);
  require_parameter(bend_radius_mm >= 3.0 * thickness_mm && bend_radius_mm <= 50.0, "bend_radius_mm",
                    bend_radius_mm,
                    fmt::format("between {:.3g} (three times thickness_mm) and 50", 3.0 * thickness_mm));
  require_within("lengthwise_crown_mm", lengthwise_crown_mm, 0.0, 0.1 * length_mm);
  require_within("crosswise_crown_deg", crosswise_crown_deg, 0.0, 45.0);

  // A ramp of width w and height h bends the sheet to a radius of w^2 / (5.77 h); where that is the thickness
  // the inner skin folds.
  const auto tallest_on = [&](double ramp_mm) { return ramp_mm * ramp_mm / (5.77 * 1.4 * thickness_mm); };
  const double tallest_bead = tallest_on(kRampToPanel * panel_mm);
  require_parameter(
      bead_height_mm >= 0.0 && bead_height_mm <= tallest_bead, "bead_height_mm", bead_height_mm,
      fmt::format("between 0 and {:.3g}, for ramps of {} of panel_mm", tallest_bead, kRampToPanel));
  const double deepest_dart =
      tallest_on(kRampToBend * bend_width_mm(*this, std::min(front_bend_deg, back_bend_deg)));
  require_parameter(
      dart_depth_mm >= 0.0 && dart_depth_mm <= deepest_dart, "dart_depth_mm", dart_depth_mm,
      fmt::format("between 0 and {:.3g}, for ramps of {} of the narrower bend", deepest_dart, kRampToBend));

  const double largest_hole = std::min(0.2 * panel_mm, 0.1 * length_mm);
  require_parameter(
      hole_diameter_mm >= 0.5 && hole_diameter_mm <= largest_hole, "hole_diameter_mm", hole_diameter_mm,
      fmt::format("between 0.5 and {:.3g} (0.2 of panel_mm and 0.1 of length_mm)", largest_hole));
  require_within("lengthwise_patches", lengthwise_patches, 1, 50);
  const double shortest_rim =
      std::min({front_flange_mm, back_flange_mm, 0.9 * length_mm / lengthwise_patches});
  require_parameter(
      corner_radius_mm >= 0.1 && corner_radius_mm <= 0.8 * shortest_rim, "corner_radius_mm", corner_radius_mm,
      fmt::format("between 0.1 and {:.3g}, to end on the first patch of the rim", 0.8 * shortest_rim));
}

int surface_count(const FormedPartParameters& p) {
  const int across = 7, along = p.lengthwise_patches;
  const int skins = 2 * across * along, rim = 2 * (across + along);
  const int corners = 4, holes = 3;
  return skins + rim + corners + holes;
}

}  // namespace trueblade
