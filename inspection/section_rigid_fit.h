// Twist and displacement of a section: how the section as a whole lies in its plane.
#pragma once

#include <optional>
#include <span>

#include "inspection/section_curve.h"

namespace trueblade {

struct SectionRigidFit {
  Vec3 twist_and_shift;  // rad about the outline's centroid, then mm along the section's axes
  Vec3 uncertainty;      // standard, from each point's own residual
};

// Weighted least squares of deviation = n . (shift + twist * perp(p - centroid)), one weight for each point.
// nullopt: the points determine no displacement.
std::optional<SectionRigidFit> fit_section_rigidly(const SectionOutline& outline,
                                                   std::span<const SectionPoint> points,
                                                   std::span<const double> weight);

}  // namespace trueblade
