#include "part/turbine_blade_shape.h"

#include "part/blade_airfoil_faces.h"
#include "part/blade_root_faces.h"
#include "part/cad_guard.h"
#include "part/require_parameter.h"

namespace trueblade {

namespace {

void require_footprint_on_platform(const BladeAirfoil& airfoil, const TurbineBladeParameters& p) {
  constexpr double kLeastRim_mm = 0.05;
  const Vec2 reach = airfoil.footprint_upper.cwiseMax(-airfoil.footprint_lower);
  require_parameter(0.5 * p.platform_length_mm >= reach.x() + kLeastRim_mm, "platform_length_mm",
                    p.platform_length_mm,
                    fmt::format("at least {:.3f} to carry the fillet", 2.0 * (reach.x() + kLeastRim_mm)));
  require_parameter(0.5 * p.platform_width_mm >= reach.y() + kLeastRim_mm, "platform_width_mm",
                    p.platform_width_mm,
                    fmt::format("at least {:.3f} to carry the fillet", 2.0 * (reach.y() + kLeastRim_mm)));
}

}  // namespace

CadShape build_turbine_blade(const TurbineBladeParameters& parameters) {
  parameters.validate();
  CadShape blade;
  with_cad_kernel("turbine_blade", "built", [&] {
    BladeAirfoil airfoil = blade_airfoil_faces(parameters);
    require_footprint_on_platform(airfoil, parameters);
    std::vector<NamedFace> faces = std::move(airfoil.faces);
    for (NamedFace& face : blade_root_faces(parameters, airfoil.footprint)) faces.push_back(std::move(face));
    blade = sew_solid(faces);
  });
  return blade;
}

}  // namespace trueblade
