// What the features of a section are called, and how finely its outline is cut: the same for measured and for
// known sections.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

namespace trueblade {

// In the order in which measure_section and then add_bow give them; places in kSectionFeatures.
enum class Feature : std::size_t {
  chord,
  stagger,
  maximum_thickness,
  leading_edge_radius,
  trailing_edge_radius,
  twist,
  displacement_x,
  displacement_y,
  bow_x,
  bow_y
};

struct SectionFeatureName {
  const char* name;
  const char* unit;
};
inline constexpr std::array<SectionFeatureName, 10> kSectionFeatures{{{"chord", "mm"},
                                                                      {"stagger", "rad"},
                                                                      {"maximum_thickness", "mm"},
                                                                      {"leading_edge_radius", "mm"},
                                                                      {"trailing_edge_radius", "mm"},
                                                                      {"twist", "rad"},
                                                                      {"displacement_x", "mm"},
                                                                      {"displacement_y", "mm"},
                                                                      {"bow_x", "mm"},
                                                                      {"bow_y", "mm"}}};
constexpr const SectionFeatureName& name_of(Feature feature) {
  return kSectionFeatures[static_cast<std::size_t>(feature)];
}

// The outline's points are no further apart than this, and its normals turn by no more between them: at an
// edge of 0.25 mm radius every 9 um, so that a point of the scan is at most a degree from the nearest.
inline constexpr double kOutlineStep_mm = 0.05;
inline constexpr double kOutlineTurn_rad = 2.0 * std::numbers::pi / 180.0;

}  // namespace trueblade
