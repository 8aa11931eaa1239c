// Defects of the part that stands on the virtual machine: how far each point of the nominal surface is
// displaced. Lengths in mm, angles in rad, positions and directions in the part frame (PCS).
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// The stacking axis of an airfoil and the stretch of it between root and tip: heights along `direction` from
// `point_mm`. Relative height is 0 at and below the root and 1 at the tip.
struct StackingAxis {
  Vec3 point_mm = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();
  double root_mm = 0.0;
  double tip_mm = 1.0;
};

// Each section turned about the stacking axis, in proportion to its relative height.
struct AirfoilTwist {
  StackingAxis axis;
  double tip_angle_rad = 0.0;
};

// Each section shifted, with the square of its relative height: a cantilever bent at its root.
struct AirfoilBend {
  StackingAxis axis;
  Vec3 tip_shift_mm = Vec3::Zero();
};

// Each section shifted by a parabola of its relative height, nothing at root and tip.
struct AirfoilBow {
  StackingAxis axis;
  Vec3 middle_shift_mm = Vec3::Zero();
};

// Everything below `top_mm` (a height as in StackingAxis) shifted against the rest: platform and root against
// the airfoil (the defect of the paper's Fig. 7). Over `blend_mm` above, the shift fades out smoothly.
struct PlatformShift {
  Vec3 point_mm = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();
  double top_mm = 0.0;
  double blend_mm = 1.0;
  Vec3 shift_mm = Vec3::Zero();
};

// A round bump (height above 0) or dent (below), a raised cosine across its diameter, on the side of the part
// that faces `outward`.
struct SurfacePatch {
  Vec3 centre_mm = Vec3::Zero();
  Vec3 outward = Vec3::UnitZ();
  double radius_mm = 1.0;
  double height_mm = 0.0;
};

// A leading edge between two points receded along `direction`, a raised cosine across.
struct WornEdge {
  Vec3 from_mm = Vec3::Zero();
  Vec3 to_mm = Vec3::UnitZ();
  Vec3 direction = Vec3::UnitX();
  double radius_mm = 1.0;
  double depth_mm = 0.0;
};

// A smooth Gaussian random field along the normal: standard deviation and correlation length l of the
// covariance amplitude^2 exp(-r^2 / (2 l^2)). Each trial has its own field.
struct RandomForm {
  double amplitude_mm = 0.0;
  double correlation_length_mm = 10.0;
};

using FormError =
    std::variant<AirfoilTwist, AirfoilBend, AirfoilBow, PlatformShift, SurfacePatch, WornEdge, RandomForm>;
using FormErrors = std::vector<FormError>;

// Throws InputError naming the kind, the value and the constraint.
void validate(const FormErrors& errors);

// The displacement of all form errors together, as one field over the nominal surface.
class DisplacementField {
 public:
  // Validates `errors`; random forms are drawn for (seed, trial, their place in the list).
  DisplacementField(const FormErrors& errors, std::uint64_t seed, std::uint64_t trial);

  bool is_zero() const { return errors_.empty(); }

  // Where the point of the nominal surface with this outward normal moves to, relative to it.
  Vec3 displacement_mm(const Vec3& point_mm, const Vec3& normal) const;

  // How long an edge of a facet near this point may be for the facets to follow the field.
  double edge_length_limit_mm(const Vec3& point_mm) const;

 private:
  // One wave of a random field: amplitude * cos(k . p + phase), along the normal.
  struct Wave {
    Vec3 wave_vector_per_mm;
    double phase_rad;
    double amplitude_mm;
  };
  FormErrors errors_;
  std::vector<Wave> waves_;
};

}  // namespace trueblade
