#include "apps/form_error_fields.h"

namespace trueblade {
namespace {

// In the order of the variant's alternatives.
constexpr std::pair<std::string_view, std::size_t> kKinds[] = {
    {"airfoil_twist", 0}, {"airfoil_bend", 1}, {"airfoil_bow", 2}, {"platform_shift", 3},
    {"patch", 4},         {"worn_edge", 5},    {"random", 6}};
static_assert(std::size(kKinds) == std::variant_size_v<FormError>);

template <std::size_t... kIndex>
FormError default_of(std::size_t kind, std::index_sequence<kIndex...>) {
  FormError error;
  ((kind == kIndex ? void(error.emplace<kIndex>()) : void()), ...);
  return error;
}

void fields(YamlFields& io, StackingAxis& axis) {
  io.vector("point_mm", axis.point_mm);
  io.vector("direction", axis.direction);
  io.number("root_mm", axis.root_mm);
  io.number("tip_mm", axis.tip_mm);
}
void axis_map(YamlFields& io, StackingAxis& axis) {
  io.map("axis", [&](YamlFields& inner) { fields(inner, axis); });
}

void fields(YamlFields& io, AirfoilTwist& twist) {
  axis_map(io, twist.axis);
  io.angle("tip_angle_deg", twist.tip_angle_rad);
}
void fields(YamlFields& io, AirfoilBend& bend) {
  axis_map(io, bend.axis);
  io.vector("tip_shift_mm", bend.tip_shift_mm);
}
void fields(YamlFields& io, AirfoilBow& bow) {
  axis_map(io, bow.axis);
  io.vector("middle_shift_mm", bow.middle_shift_mm);
}
void fields(YamlFields& io, PlatformShift& shift) {
  io.vector("point_mm", shift.point_mm);
  io.vector("direction", shift.direction);
  io.number("top_mm", shift.top_mm);
  io.number("blend_mm", shift.blend_mm);
  io.vector("shift_mm", shift.shift_mm);
}
void fields(YamlFields& io, SurfacePatch& patch) {
  io.vector("centre_mm", patch.centre_mm);
  io.vector("outward", patch.outward);
  io.number("radius_mm", patch.radius_mm);
  io.number("height_mm", patch.height_mm);
}
void fields(YamlFields& io, WornEdge& edge) {
  io.vector("from_mm", edge.from_mm);
  io.vector("to_mm", edge.to_mm);
  io.vector("direction", edge.direction);
  io.number("radius_mm", edge.radius_mm);
  io.number("depth_mm", edge.depth_mm);
}
void fields(YamlFields& io, RandomForm& form) {
  io.number("amplitude_mm", form.amplitude_mm);
  io.number("correlation_length_mm", form.correlation_length_mm);
}

}  // namespace

void fields(YamlFields& io, FormError& error) {
  std::size_t kind = error.index();
  io.require("kind");
  io.choice<std::size_t>("kind", kind, kKinds);
  if (io.reading()) error = default_of(kind, std::make_index_sequence<std::variant_size_v<FormError>>());
  std::visit([&](auto& alternative) { fields(io, alternative); }, error);
  io.check([&] { validate({error}); });
}

}  // namespace trueblade
