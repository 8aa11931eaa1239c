#include "part/cad_spline.h"

#include <BSplCLib.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <stdexcept>

namespace trueblade {

namespace {

constexpr int kDegree = 3;

int size_of(const auto& values) {
  return static_cast<int>(values.size());
}

TColStd_Array1OfReal to_array(const std::vector<double>& values) {
  TColStd_Array1OfReal array(1, size_of(values));
  for (int i = 0; i < size_of(values); ++i) array(i + 1) = values[static_cast<std::size_t>(i)];
  return array;
}

// Poles of the spline over `flat_knots` that takes values[i] in its derivative of order orders[i] at
// parameters[i].
std::vector<Vec3> interpolated_poles(const std::vector<double>& flat_knots,
                                     const std::vector<double>& parameters, const std::vector<int>& orders,
                                     const std::vector<Vec3>& values) {
  TColStd_Array1OfInteger order_array(1, size_of(orders));
  TColgp_Array1OfPnt poles(1, size_of(values));
  for (int i = 0; i < size_of(values); ++i) {
    order_array(i + 1) = orders[static_cast<std::size_t>(i)];
    poles(i + 1) = to_gp(values[static_cast<std::size_t>(i)]);
  }
  int problem = 0;
  BSplCLib::Interpolate(kDegree, to_array(flat_knots), to_array(parameters), order_array, poles, problem);
  if (problem != 0) throw std::logic_error("interpolated_poles: parameters do not rise or are too few");
  std::vector<Vec3> result;
  for (const gp_Pnt& pole : poles) result.push_back(from_gp(pole.XYZ()));
  return result;
}

std::vector<double> clamped_knots(const std::vector<double>& parameters, std::size_t first_inner,
                                  std::size_t end_inner) {
  std::vector<double> knots(kDegree + 1, parameters.front());
  for (std::size_t i = first_inner; i < end_inner; ++i) knots.push_back(parameters[i]);
  knots.insert(knots.end(), kDegree + 1, parameters.back());
  return knots;
}

struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;

  explicit Knots(const std::vector<double>& flat_knots)
      : values(1, BSplCLib::KnotsLength(to_array(flat_knots))), multiplicities(1, values.Length()) {
    BSplCLib::Knots(to_array(flat_knots), values, multiplicities);
  }
};

}  // namespace

CubicSpline complete_spline(const CurveSamples& samples) {
  std::vector<double> parameters = samples.parameters;
  std::vector<Vec3> values = samples.points;
  std::vector<int> orders(values.size(), 0);
  parameters.insert(parameters.begin() + 1, samples.parameters.front());
  parameters.insert(parameters.end() - 1, samples.parameters.back());
  values.insert(values.begin() + 1, samples.first_derivative);
  values.insert(values.end() - 1, samples.last_derivative);
  orders.insert(orders.begin() + 1, 1);
  orders.insert(orders.end() - 1, 1);
  const auto knots = clamped_knots(samples.parameters, 1, samples.parameters.size() - 1);
  return {knots, interpolated_poles(knots, parameters, orders, values)};
}

CubicSpline not_a_knot_spline(const std::vector<double>& parameters, const std::vector<Vec3>& points) {
  const auto knots = clamped_knots(parameters, 2, parameters.size() - 2);
  return {knots, interpolated_poles(knots, parameters, std::vector<int>(points.size(), 0), points)};
}

Handle(Geom_BSplineCurve) curve_of(const CubicSpline& spline) {
  const Knots knots(spline.flat_knots);
  TColgp_Array1OfPnt poles(1, size_of(spline.poles));
  for (int i = 0; i < size_of(spline.poles); ++i)
    poles(i + 1) = to_gp(spline.poles[static_cast<std::size_t>(i)]);
  return new Geom_BSplineCurve(poles, knots.values, knots.multiplicities, kDegree);
}

Handle(Geom_BSplineSurface)
    surface_of(const std::vector<double>& flat_knots_u, const std::vector<double>& flat_knots_v,
               const std::vector<std::vector<Vec3>>& rows) {
  TColgp_Array2OfPnt poles(1, size_of(rows.front()), 1, size_of(rows));
  for (std::size_t v = 0; v < rows.size(); ++v)
    for (std::size_t u = 0; u < rows[v].size(); ++u)
      poles(static_cast<int>(u) + 1, static_cast<int>(v) + 1) = to_gp(rows[v][u]);
  const Knots u(flat_knots_u), v(flat_knots_v);
  return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities, kDegree,
                                 kDegree);
}

Handle(Geom_BSplineSurface) skin(const std::vector<double>& flat_knots_u, const std::vector<double>& stations,
                                 const std::vector<std::vector<Vec3>>& sections) {
  std::vector<std::vector<Vec3>> rows(sections.size());
  std::vector<double> flat_knots_v;
  for (std::size_t u = 0; u < sections.front().size(); ++u) {
    std::vector<Vec3> column;
    for (const auto& section : sections) column.push_back(section[u]);
    const CubicSpline spline = not_a_knot_spline(stations, column);
    flat_knots_v = spline.flat_knots;
    for (std::size_t v = 0; v < rows.size(); ++v) rows[v].push_back(spline.poles[v]);
  }
  return surface_of(flat_knots_u, flat_knots_v, rows);
}

Handle(Geom_BSplineSurface) patch_of(const Handle(Geom_BSplineSurface) & surface, double u_first,
                                     double u_last, double v_first, double v_last) {
  Handle(Geom_BSplineSurface) patch = Handle(Geom_BSplineSurface)::DownCast(surface->Copy());
  patch->Segment(u_first, u_last, v_first, v_last);
  return patch;
}

std::vector<double> equally_spaced(double first, double last, int intervals) {
  std::vector<double> values;
  for (int i = 0; i < intervals; ++i) values.push_back(first + (last - first) * i / intervals);
  values.push_back(last);
  return values;
}

}  // namespace trueblade
