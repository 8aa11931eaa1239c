#include "part/formed_part_parameters.h"

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
  // A ramp of width w and height h bends the sheet to a radius of w^2 / (5.77 h); it must stay above twice
  // the thickness or the inner skin folds.
  const double ramp = kRampToPanel * panel_mm;
  const double tallest_bead = ramp * ramp / (5.77 * 2.0 * thickness_mm);
  require_parameter(
      bead_height_mm >= 0.0 && bead_height_mm <= tallest_bead, "bead_height_mm", bead_height_mm,
      fmt::format("between 0 and {:.3g}, for ramps of {} of panel_mm", tallest_bead, kRampToPanel));
}

int surface_count(const FormedPartParameters& p) {
  const int across = 7, along = p.lengthwise_patches;
  const int skins = 2 * across * along, rim = 2 * (across + along);
  const int corners = 4, holes = 3;
  return skins + rim + corners + holes;
}

}  // namespace trueblade
