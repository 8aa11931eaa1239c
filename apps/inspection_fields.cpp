#include "apps/inspection_fields.h"

#include <fmt/format.h>

namespace trueblade {
namespace {

constexpr std::pair<std::string_view, DeviationSurface> kDeviationSurfaces[] = {
    {"exact", DeviationSurface::exact}, {"facets", DeviationSurface::facets}};
constexpr std::pair<std::string_view, ColourMap> kColourMaps[] = {
    {"blue_green_red", ColourMap::blue_green_red}, {"blue_white_orange", ColourMap::blue_white_orange}};

void fields(YamlFields& io, ProfileSpec& profile) {
  io.require("name");
  io.text("name", profile.name);
  io.texts("surfaces", profile.surfaces);
  std::optional<std::pair<double, double>> limits{{profile.tolerance.lower_mm, profile.tolerance.upper_mm}};
  io.require("tolerance_mm");
  io.interval("tolerance_mm", limits);
  profile.tolerance = {limits->first, limits->second};
  io.check([&] { profile.tolerance.validate(); });
}

void fields(YamlFields& io, SectionsSpec& sections) {
  io.require("heights_mm");
  io.numbers("heights_mm", sections.heights_mm);
  io.vector("origin_mm", sections.origin_mm);
  io.vector("normal", sections.normal);
  io.vector("x_direction", sections.x_direction);
  io.number("half_width_mm", sections.half_width_mm, above(0.0));
  io.check([&] { sections.validate(); });
}

void fields(YamlFields& io, GroupSpec& group) {
  io.require("name");
  io.text("name", group.name);
  io.require("surfaces");
  io.texts("surfaces", group.surfaces);
}

}  // namespace

void fields(YamlFields& io, InspectionSpec& inspection) {
  io.choice<DeviationSurface>("surface", inspection.surface, kDeviationSurfaces);
  io.interval("tolerance_mm", inspection.tolerance_mm);
  if (inspection.tolerance_mm)
    io.check([&] { Tolerance{inspection.tolerance_mm->first, inspection.tolerance_mm->second}.validate(); });
  io.number("colour_limit_mm", inspection.colour_limit_mm, above(0.0));
  io.choice<ColourMap>("colour_map", inspection.colour_map, kColourMaps);
  io.number("point_uncertainty_mm", inspection.point_uncertainty_mm, at_least(0.0));
  io.texts("datum_surfaces", inspection.datum_surfaces);
  io.list<ProfileSpec>("profiles", inspection.profiles,
                       [](YamlFields& inner, ProfileSpec& profile) { fields(inner, profile); });
  io.optional_map<SectionsSpec>("sections", inspection.sections,
                                [](YamlFields& inner, SectionsSpec& sections) { fields(inner, sections); });
  io.list<GroupSpec>("groups", inspection.groups,
                     [](YamlFields& inner, GroupSpec& group) { fields(inner, group); });
}

}  // namespace trueblade
