// Twist and displacement of a section: how the section as a whole lies in its plane.
#pragma once

#include <optional>
#include <span>

#include "inspection/section_outline.h"

namespace trueblade {

// A point of the section as it truly is, in the section's coordinates, and the point of the nominal outline
// from which it came, or one near it.
struct PlacedPoint {
  std::size_t outline_point;
  Vec2 point_mm;
};

struct SectionRigidFit {
  Vec3 twist_and_shift;  // rad about the outline's centroid, then mm along the section's axes
  Vec3 uncertainty;      // standard, from each point's own residual
};

// Weighted least squares of the distances from the outline, moved as a whole, to the points; one weight for
// each point. Gauss-Newton steps with new closest points: an edge of 0.2 mm radius that moved by 0.1 mm is
// far from the linear n . u. nullopt: the points determine no displacement, or the steps do not converge.
std::optional<SectionRigidFit> fit_section_rigidly(const SectionOutline& outline,
                                                   std::span<const PlacedPoint> points,
                                                   std::span<const double> weight);

}  // namespace trueblade
