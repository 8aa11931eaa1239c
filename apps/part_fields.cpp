#include "apps/part_fields.h"

#include <mutex>

namespace trueblade {
namespace {

constexpr std::pair<std::string_view, Demonstration> kDemonstrations[] = {
    {"turbine_blade", Demonstration::turbine_blade},
    {"formed_part", Demonstration::formed_part},
    {"reference_sphere", Demonstration::reference_sphere}};
constexpr std::pair<std::string_view, LengthUnit> kUnits[] = {{"mm", LengthUnit::millimetre},
                                                              {"cm", LengthUnit::centimetre},
                                                              {"m", LengthUnit::metre},
                                                              {"in", LengthUnit::inch},
                                                              {"um", LengthUnit::micrometre}};

}  // namespace

void fields(YamlFields& io, TurbineBladeParameters& blade, const std::filesystem::path& folder) {
  std::filesystem::path section = blade.section_file;
  io.path("section_file", section, folder);
  blade.section_file = section.string();
  io.number("section_lift_coefficient", blade.section_lift_coefficient);
  io.number("span_mm", blade.span_mm);
  io.number("root_chord_mm", blade.root_chord_mm);
  io.number("tip_chord_mm", blade.tip_chord_mm);
  io.number("root_max_thickness_mm", blade.root_max_thickness_mm);
  io.number("tip_max_thickness_mm", blade.tip_max_thickness_mm);
  io.number("root_leading_edge_radius_mm", blade.root_leading_edge_radius_mm);
  io.number("tip_leading_edge_radius_mm", blade.tip_leading_edge_radius_mm);
  io.number("root_trailing_edge_radius_mm", blade.root_trailing_edge_radius_mm);
  io.number("tip_trailing_edge_radius_mm", blade.tip_trailing_edge_radius_mm);
  io.number("root_camber_factor", blade.root_camber_factor);
  io.number("tip_camber_factor", blade.tip_camber_factor);
  io.number("root_stagger_deg", blade.root_stagger_deg);
  io.number("tip_stagger_deg", blade.tip_stagger_deg);
  io.number("fillet_radius_mm", blade.fillet_radius_mm);
  io.number("platform_length_mm", blade.platform_length_mm);
  io.number("platform_width_mm", blade.platform_width_mm);
  io.number("platform_thickness_mm", blade.platform_thickness_mm);
  io.number("root_length_mm", blade.root_length_mm);
  io.number("root_height_mm", blade.root_height_mm);
  io.number("root_neck_width_mm", blade.root_neck_width_mm);
  io.number("root_neck_height_mm", blade.root_neck_height_mm);
  io.number("root_taper_deg", blade.root_taper_deg);
  io.number("root_tooth_depth_mm", blade.root_tooth_depth_mm);
  io.number("root_corner_radius_mm", blade.root_corner_radius_mm);
  io.integer("root_teeth", blade.root_teeth, 0, 1000);
  io.integer("spanwise_patches", blade.spanwise_patches, 0, 1000);
  io.integer("chordwise_patches", blade.chordwise_patches, 0, 1000);
  io.check([&] { blade.validate(); });
}

void fields(YamlFields& io, FormedPartParameters& formed) {
  io.number("length_mm", formed.length_mm);
  io.number("thickness_mm", formed.thickness_mm);
  io.number("front_flange_mm", formed.front_flange_mm);
  io.number("panel_mm", formed.panel_mm);
  io.number("back_flange_mm", formed.back_flange_mm);
  io.number("front_bend_deg", formed.front_bend_deg);
  io.number("back_bend_deg", formed.back_bend_deg);
  io.number("bend_twist_deg", formed.bend_twist_deg);
  io.number("bend_radius_mm", formed.bend_radius_mm);
  io.number("lengthwise_crown_mm", formed.lengthwise_crown_mm);
  io.number("crosswise_crown_deg", formed.crosswise_crown_deg);
  io.number("bead_height_mm", formed.bead_height_mm);
  io.number("dart_depth_mm", formed.dart_depth_mm);
  io.number("corner_radius_mm", formed.corner_radius_mm);
  io.number("hole_diameter_mm", formed.hole_diameter_mm);
  io.integer("lengthwise_patches", formed.lengthwise_patches, 0, 1000);
  io.check([&] { formed.validate(); });
}

void fields(YamlFields& io, ReferenceSphereParameters& sphere) {
  io.number("diameter_mm", sphere.diameter_mm);
  io.check([&] { sphere.validate(); });
}

void fields(YamlFields& io, PartSpec& part, const std::filesystem::path& folder) {
  const bool has_file = io.reading() ? io.present("file") : !part.file.empty();
  const bool is_demonstration =
      io.reading() ? io.present("demonstration") : part.demonstration != Demonstration::none;
  io.fail_unless(has_file != is_demonstration, "part must have either file or demonstration");
  if (has_file) {
    io.path("file", part.file, folder);
    if (io.reading() || !part.origin.empty()) io.text("origin", part.origin);
    io.choice<LengthUnit>("unit", part.options.unit, kUnits);
  }
  if (is_demonstration) {
    io.choice<Demonstration>("demonstration", part.demonstration, kDemonstrations);
    io.map("parameters", [&](YamlFields& inner) {
      if (part.demonstration == Demonstration::turbine_blade)
        fields(inner, part.turbine_blade, folder);
      else if (part.demonstration == Demonstration::formed_part)
        fields(inner, part.formed_part);
      else
        fields(inner, part.reference_sphere);
    });
  }
  io.number("chord_tolerance_mm", part.options.faceting.chord_tolerance_mm);
  io.angle("angular_tolerance_deg", part.options.faceting.angular_tolerance_rad);
  io.check([&] { part.options.faceting.validate(); });
}

Part make_part(const PartSpec& spec) {
  // OpenCASCADE's readers and modellers keep global state; scenarios may run side by side.
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  switch (spec.demonstration) {
    case Demonstration::turbine_blade:
      return make_turbine_blade(spec.turbine_blade, spec.options.faceting);
    case Demonstration::formed_part:
      return make_formed_part(spec.formed_part, spec.options.faceting);
    case Demonstration::reference_sphere:
      return make_reference_sphere(spec.reference_sphere, spec.options.faceting);
    case Demonstration::none:
      break;
  }
  std::error_code unreadable;  // read_part says why
  if (!spec.origin.empty() && !std::filesystem::exists(spec.file, unreadable))
    throw file_error(spec.file.string(), "no such file; it is not part of this project: " + spec.origin);
  return read_part(spec.file, spec.options);
}

std::string title_of(const PartSpec& spec) {
  for (const auto& [name, demonstration] : kDemonstrations)
    if (demonstration == spec.demonstration) return std::string(name);
  return spec.file.filename().string();
}

}  // namespace trueblade
