// The features of a section of a part whose form error is known everywhere, as it is in a simulation: what
// measure_section should find.
#pragma once

#include <functional>

#include "inspection/measure_section.h"
#include "registration/target.h"

namespace trueblade {

// Where the true surface lies: the displacement of a point of the nominal surface with this unit outward
// normal. Part frame, mm.
using SurfaceDisplacement = std::function<Vec3(const Vec3& point_mm, const Vec3& normal)>;

class KnownSection {
 public:
  // Cuts the nominal part once. Throws InputError when the plane finds no closed outline.
  KnownSection(const RegistrationTarget& target, const SectionsSpec& spec, double height_mm);

  // The features of measure_section by their definitions, from the nominal and the displaced outline: no
  // points, no curve through them, no uncertainty. Twist and displacement are least squares over the outline,
  // every stretch by its length. Correct to first order in the slope of the displacement.
  SectionResult features(const SurfaceDisplacement& displacement) const;

 private:
  double height_mm_;
  SectionPlane plane_;
  SectionOutline outline_;
  std::vector<Vec3> point_mm_;  // of the outline, part frame
  std::vector<Vec3> normal_;    // of the nominal surface there
};

}  // namespace trueblade
