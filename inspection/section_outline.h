// A plane section of the nominal part: the closed outline of the material.
#pragma once

#include <vector>

#include "part/part.h"

namespace trueblade {

// The cutting plane: points p with normal . (p - origin) = 0. `x_direction` is the first axis of the
// section's own coordinates, the second is normal x x_direction. Unit, perpendicular.
struct SectionPlane {
  Vec3 origin_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  Vec3 x_direction = Vec3::UnitX();

  double height_mm(const Vec3& point_mm) const { return normal.dot(point_mm - origin_mm); }
  Vec2 in_plane(const Vec3& vector) const {
    return {x_direction.dot(vector), normal.cross(x_direction).dot(vector)};
  }
  Vec2 section_mm(const Vec3& point_mm) const { return in_plane(point_mm - origin_mm); }
};

// Counter-clockwise seen against the plane's normal, material on the left; the last point joins the first.
struct SectionOutline {
  std::vector<Vec2> point_mm;
  std::vector<Vec2> normal;    // unit, out of the material
  std::vector<double> arc_mm;  // from the first point along the outline
  double length_mm = 0.0;
  double area_mm2 = 0.0;
  Vec2 centroid_mm = Vec2::Zero();  // of the area

  std::size_t size() const { return point_mm.size(); }
};

// The outline through points in order, counter-clockwise; normals, arc lengths and area follow from them.
SectionOutline outline_through(std::vector<Vec2> points_mm);

// The outline of the largest area where the plane cuts the part, with points no further apart than
// `max_step_mm`; they lie on the exact CAD surface where the part has one, and there its direction turns by
// no more than about `max_turn_rad` from one to the next. Throws InputError when the plane misses the part or
// the facets there form no closed outline.
SectionOutline cut_outline(const Part& part, const SectionPlane& plane, double max_step_mm,
                           double max_turn_rad);

}  // namespace trueblade
