// What the features of a section are called, and how finely its outline is cut: the same for measured and for
// known sections.
#pragma once

#include <array>

namespace trueblade {

// In the order in which measure_section and then add_bow give them.
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

inline constexpr double kOutlineStep_mm = 0.05;  // 11 degrees of an edge of 0.25 mm radius

}  // namespace trueblade
