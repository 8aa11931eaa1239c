// Features of a closed airfoil outline: maximum chord and its angle, largest inscribed circle, circles of the
// edges. The nominal and the measured outline go through the same functions.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "inspection/section_outline.h"

namespace trueblade {

// The two points that lie farthest apart: the maximum chord. Its ends lie between the outline's points, on
// parabolas through three of them, except at a sharp corner. The leading edge is the end with the smaller
// first coordinate (against the section's x direction).
struct Chord {
  std::size_t leading, trailing;  // the outline's points at the ends
  double length_mm;
  double stagger_rad;  // angle from the x direction to the chord, leading to trailing edge
};
Chord maximum_chord(const SectionOutline& outline);

// The largest circle inside the outline that touches it at `first` and `second`; its diameter is the maximum
// thickness.
struct InscribedCircle {
  Vec2 centre_mm;
  double diameter_mm;
  std::size_t first, second;
};
// `start`: a point where the circle is thought to touch; it makes the search faster and changes nothing else.
InscribedCircle largest_inscribed_circle(const SectionOutline& outline, std::size_t start = 0);

// The outline points around `apex` whose normals lie within 50 degrees of the direction in which the edge
// points: an arc of 100 degrees when the edge is round. In order along the outline.
std::vector<std::size_t> edge_region(const SectionOutline& outline, std::size_t apex, const Vec2& direction);

// Circle of least squared distances (Gauss-Newton from the algebraic fit). nullopt: fewer than 4 points, or
// points on a line.
struct FittedCircle {
  Vec2 centre_mm;
  double radius_mm;
  double rms_mm;
  double radius_uncertainty_mm;  // standard, from the residuals; zero for a perfect fit
};
std::optional<FittedCircle> fit_circle(std::span<const Vec2> points_mm);

}  // namespace trueblade
