#include "part/spline_surface.h"

#include <algorithm>
#include <array>
#include <utility>

namespace trueblade {

namespace {

constexpr std::size_t kMostBasis = SplineSurface::kHighestDegree + 1;

// The basis functions that do not vanish on one span, and their first two derivatives.
struct Basis {
  std::size_t first_pole = 0;                                // number of the first pole that takes part
  std::array<std::array<double, kMostBasis>, 3> derivative;  // [order][pole - first_pole]
};

// The knots around a span, and the inverse differences that each degree divides by, those of degree 1 first:
// 1 / (knots[span + r + 1] - knots[span + 1 - degree + r]), r = 0 ... degree - 1. Kept because a division
// takes several times as long as all that is done with its result. They are infinite in spans without length,
// which hold no parameter.
struct Span {
  const double* knot;
  const double* inverse;
  const double* inverse_of(std::size_t degree) const { return inverse + degree * (degree - 1) / 2; }
};

constexpr std::size_t inverses_per_span(std::size_t degree) {
  return degree * (degree + 1) / 2;
}

std::vector<double> inverse_differences(const SplineSurface::Direction& direction) {
  const auto degree = static_cast<std::size_t>(direction.degree);
  std::vector<double> inverse;
  inverse.reserve((direction.poles() - degree) * inverses_per_span(degree));
  for (std::size_t span = degree; span < direction.poles(); ++span)
    for (std::size_t k = 1; k <= degree; ++k)
      for (std::size_t r = 0; r < k; ++r)
        inverse.push_back(1.0 / (direction.knots[span + r + 1] - direction.knots[span + 1 - k + r]));
  return inverse;
}

// Raises the basis from degree - 1 to `degree` in place (Cox and de Boor; Piegl and Tiller, A2.2).
void raise_degree(std::array<double, kMostBasis>& basis, std::size_t degree, const Span& span, double t) {
  const double* const right = span.knot + 1;
  const double* const left = right - degree;
  const double* const inverse = span.inverse_of(degree);
  double carried = 0.0;
  for (std::size_t r = 0; r < degree; ++r) {
    const double share = basis[r] * inverse[r];
    basis[r] = carried + (right[r] - t) * share;
    carried = (t - left[r]) * share;
  }
  basis[degree] = carried;
}

// The derivative of a basis of `degree` from the same derivative, one order lower, of the basis of degree - 1
// (Piegl and Tiller, eq. 2.7).
void differentiate(const std::array<double, kMostBasis>& lower, std::array<double, kMostBasis>& derivative,
                   std::size_t degree, const Span& span) {
  const double* const inverse = span.inverse_of(degree);
  double carried = 0.0;
  for (std::size_t r = 0; r < degree; ++r) {
    const double share = static_cast<double>(degree) * lower[r] * inverse[r];
    derivative[r] = carried - share;
    carried = share;
  }
  derivative[degree] = carried;
}

void compute_basis(const SplineSurface::Direction& direction, const std::vector<double>& inverse, double t,
                   Basis& basis) {
  const auto degree = static_cast<std::size_t>(direction.degree);
  const std::vector<double>& knots = direction.knots;
  // The span [knots[span], knots[span + 1]) that holds t, the last one for t at the end.
  const auto begin = knots.begin() + static_cast<std::ptrdiff_t>(degree + 1);
  const auto end = knots.begin() + static_cast<std::ptrdiff_t>(direction.poles());
  const std::size_t number = static_cast<std::size_t>(std::upper_bound(begin, end, t) - knots.begin()) - 1;
  basis.first_pole = number - degree;
  const Span span{&knots[number], &inverse[basis.first_pole * inverses_per_span(degree)]};

  auto& [value, first, second] = basis.derivative;
  value[0] = 1.0;
  for (std::size_t k = 1; k + 1 < degree; ++k) raise_degree(value, k, span, t);
  // `value` has degree - 2 (or 0). The derivatives are built on the way up.
  if (degree == 1) {
    differentiate(value, first, 1, span);
    std::fill_n(second.begin(), 2, 0.0);
    raise_degree(value, 1, span, t);
    return;
  }
  std::array<double, kMostBasis> first_of_lower;  // first derivative at degree - 1
  differentiate(value, first_of_lower, degree - 1, span);
  differentiate(first_of_lower, second, degree, span);
  raise_degree(value, degree - 1, span, t);
  differentiate(value, first, degree, span);
  raise_degree(value, degree, span, t);
}

}  // namespace

SplineSurface::SplineSurface(Direction u, Direction v, std::span<const Vec3> poles,
                             std::span<const double> weights)
    : u_(std::move(u)),
      v_(std::move(v)),
      inverse_u_(inverse_differences(u_)),
      inverse_v_(inverse_differences(v_)),
      rational_(!weights.empty()) {
  poles_.reserve(poles.size());
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const double w = rational_ ? weights[i] : 1.0;
    poles_.emplace_back(w * poles[i].x(), w * poles[i].y(), w * poles[i].z(), w);
  }
}

SurfaceDerivatives SplineSurface::at(const Vec2& uv) const {
  Basis bu, bv;
  compute_basis(u_, inverse_u_, uv.x(), bu);
  compute_basis(v_, inverse_v_, uv.y(), bv);

  // The sums over v are taken once for every row of poles.
  Vec4 s = Vec4::Zero(), su = s, sv = s, suu = s, suv = s, svv = s;
  const std::size_t row_length = v_.poles();
  for (std::size_t i = 0; i <= static_cast<std::size_t>(u_.degree); ++i) {
    const Vec4* pole = &poles_[(bu.first_pole + i) * row_length + bv.first_pole];
    Vec4 row = Vec4::Zero(), row_v = row, row_vv = row;
    for (std::size_t j = 0; j <= static_cast<std::size_t>(v_.degree); ++j) {
      row += bv.derivative[0][j] * pole[j];
      row_v += bv.derivative[1][j] * pole[j];
      row_vv += bv.derivative[2][j] * pole[j];
    }
    const double n = bu.derivative[0][i], nu = bu.derivative[1][i], nuu = bu.derivative[2][i];
    s += n * row;
    su += nu * row;
    suu += nuu * row;
    sv += n * row_v;
    suv += nu * row_v;
    svv += n * row_vv;
  }
  if (!rational_)
    return {s.head<3>(), su.head<3>(), sv.head<3>(), suu.head<3>(), suv.head<3>(), svv.head<3>()};

  // S = A / w, differentiated (Piegl and Tiller, eq. 4.20).
  SurfaceDerivatives d;
  const double w = s[3];
  d.point = s.head<3>() / w;
  d.du = (su.head<3>() - su[3] * d.point) / w;
  d.dv = (sv.head<3>() - sv[3] * d.point) / w;
  d.duu = (suu.head<3>() - 2 * su[3] * d.du - suu[3] * d.point) / w;
  d.duv = (suv.head<3>() - su[3] * d.dv - sv[3] * d.du - suv[3] * d.point) / w;
  d.dvv = (svv.head<3>() - 2 * sv[3] * d.dv - svv[3] * d.point) / w;
  return d;
}

}  // namespace trueblade
