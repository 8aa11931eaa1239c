// Cubic B-spline curves and surfaces through given points. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <gp_Pnt.hxx>
#include <vector>

#include "geometry/vector.h"

namespace trueblade {

inline gp_Pnt to_gp(const Vec3& point) {
  return {point.x(), point.y(), point.z()};
}
inline Vec3 from_gp(const gp_XYZ& point) {
  return {point.X(), point.Y(), point.Z()};
}

// Points of a curve at rising parameters with the derivative by the parameter at both ends.
struct CurveSamples {
  std::vector<double> parameters;
  std::vector<Vec3> points;
  Vec3 first_derivative, last_derivative;
};

// A cubic in one variable: flat knots (each as often as its multiplicity) and poles.
struct CubicSpline {
  std::vector<double> flat_knots;
  std::vector<Vec3> poles;
};

// Twice continuously differentiable cubic through the samples, with a knot at every parameter ("complete"
// spline). Its basis depends on the parameters alone.
CubicSpline complete_spline(const CurveSamples& samples);

// The same without end derivatives: the first two and the last two intervals are one cubic each (de Boor
// 2001, chapter IV). Precondition: at least four points.
CubicSpline not_a_knot_spline(const std::vector<double>& parameters, const std::vector<Vec3>& points);

Handle(Geom_BSplineCurve) curve_of(const CubicSpline& spline);

// Surface S(u, v) whose row of poles along u at `v_pole` is `rows[v_pole]`.
Handle(Geom_BSplineSurface)
    surface_of(const std::vector<double>& flat_knots_u, const std::vector<double>& flat_knots_v,
               const std::vector<std::vector<Vec3>>& rows);

// Skinning: the surface whose curve at v = stations[j] has the poles sections[j] over `flat_knots_u`,
// not-a-knot in v.
Handle(Geom_BSplineSurface) skin(const std::vector<double>& flat_knots_u, const std::vector<double>& stations,
                                 const std::vector<std::vector<Vec3>>& sections);

// The part of the surface over a rectangle of its parameters, with the same parameters and the same points.
Handle(Geom_BSplineSurface) patch_of(const Handle(Geom_BSplineSurface) & surface, double u_first,
                                     double u_last, double v_first, double v_last);

// n + 1 numbers from first to last, equally spaced; both ends exact.
std::vector<double> equally_spaced(double first, double last, int intervals);

}  // namespace trueblade
