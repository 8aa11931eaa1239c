// A blade section measured: the nominal outline at a height, the measured points near it, and the features of
// both by the same methods.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "inspection/deviations.h"
#include "inspection/section_outline.h"

namespace trueblade {

// Sections across one axis, as the stacking axis of a blade.
struct SectionsSpec {
  std::vector<double> heights_mm;  // along the normal from the origin
  Vec3 origin_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  Vec3 x_direction = Vec3::UnitX();  // from leading to trailing edge, roughly
  double half_width_mm = 1.0;        // points this near to the plane belong to the section

  void validate() const;  // throws InputError: unit directions at right angles, width above 0
  SectionPlane plane(double height_mm) const;
};

// Lengths in mm, angles in rad; `deviation` is measured minus nominal.
struct SectionFeature {
  std::string name;
  std::string unit;
  std::string method;
  double nominal = std::numeric_limits<double>::quiet_NaN();
  double measured = std::numeric_limits<double>::quiet_NaN();
  double uncertainty = std::numeric_limits<double>::quiet_NaN();  // standard
  std::string reason;                                             // why there is no measured number

  double deviation() const { return measured - nominal; }
};

struct SectionResult {
  double height_mm = 0.0;
  std::size_t points = 0;
  double covered_percent = 0.0;  // of the outline's length
  std::string missing;           // why there are no features at all
  std::vector<SectionFeature> features;

  // For the picture, in the section's coordinates.
  std::vector<Vec2> outline_mm;
  std::vector<Vec2> outline_normal;
  std::vector<double> fitted_deviation_mm;  // along the outline; NaN where nothing was measured
  std::vector<Vec2> foot_mm;                // of the measured points, on the nominal outline
  std::vector<double> deviation_mm;

  const SectionFeature* find(const std::string& name) const;
};

// Features, each with its method in words:
//   chord, stagger                  of the maximum chord
//   maximum_thickness               diameter of the largest inscribed circle
//   leading_ and trailing_edge_radius  least-squares circle through the points of the edge, when there are
//                                   enough on both sides of it to tell the radius
//   twist, displacement_x and _y    rotation and shift of the section as a whole (best fit in the plane)
//   about
//                                   the nominal centroid of the area
// A point off the plane is moved into it along its tangent plane, then the outline is moved by the smooth
// curve through the deviations (section_curve.h). Uncertainties are those of the points' scatter: 40
// outlines drawn from the curve's covariance, or the fit's own. The pose's uncertainty is not in them; it
// moves twist and displacement, and leaves the rest alone.
// A section that cannot be measured says why in `missing`.
SectionResult measure_section(const Part& part, const SectionsSpec& spec, double height_mm,
                              const Deviations& deviations);

// Adds bow_x and bow_y to the inner sections: their displacement from the straight line between those of the
// first and the last section that have one.
void add_bow(std::vector<SectionResult>& sections);

}  // namespace trueblade
