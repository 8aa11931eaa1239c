// Mean line and thickness of a section, as blade metrology defines them: the mean line is the locus of the
// centres of the circles inscribed in the outline, the half-thickness their radius. For the sources of part/
// that include OpenCASCADE.
#pragma once

#include <Geom_BSplineCurve.hxx>

#include "geometry/vector.h"
#include "part/airfoil.h"

namespace trueblade {

class MeanLine {
 public:
  // Throws InputError when the outline encloses no chain of circles from nose to tail.
  explicit MeanLine(const AirfoilSection& section);

  // The inscribed circle at x (unit chord), with derivatives by x.
  struct Circle {
    Vec2 centre, centre_by_x;
    double radius, radius_by_x;
  };
  Circle at(double x) const;

  double first_x() const { return curve_->FirstParameter(); }
  double last_x() const { return curve_->LastParameter(); }
  double x_of_largest_radius() const { return x_of_largest_radius_; }

 private:
  Handle(Geom_BSplineCurve) curve_;  // (x, y, radius) by x
  double x_of_largest_radius_ = 0.0;
};

}  // namespace trueblade
