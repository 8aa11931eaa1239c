// Evaluation of B-spline and NURBS surfaces (Piegl and Tiller 1997, chapters 2 to 4). Ours because
// OpenCASCADE's own takes five times as long without a cache, and its cache is bound to one thread.
#pragma once

#include <span>
#include <vector>

#include "geometry/vector.h"
#include "part/surface_derivatives.h"

namespace trueblade {

class SplineSurface {
 public:
  static constexpr int kHighestDegree = 25;  // OpenCASCADE's own limit

  // One direction: degree and knots with their multiplicities written out, one more than poles + degree.
  struct Direction {
    int degree = 0;
    std::vector<double> knots;
    std::size_t poles() const { return knots.size() - static_cast<std::size_t>(degree) - 1; }
    double first() const { return knots[static_cast<std::size_t>(degree)]; }
    double last() const { return knots[poles()]; }
  };

  // `poles` and `weights` run along v first: pole (i, j) is poles[i * v.poles() + j]. `weights` is empty for
  // a polynomial surface. Preconditions: sizes agree, knots rise, weights are positive, degrees are 1 to
  // kHighestDegree.
  SplineSurface(Direction u, Direction v, std::span<const Vec3> poles, std::span<const double> weights);

  // Outside the knots the first or last polynomial piece is continued.
  SurfaceDerivatives at(const Vec2& uv) const;

 private:
  Direction u_, v_;
  std::vector<double> inverse_u_, inverse_v_;  // of differences of knots, span after span
  bool rational_;
  // (w x, w y, w z, w) of every pole; w = 1 for a polynomial surface.
  using Vec4 = Eigen::Vector4d;
  std::vector<Vec4, Eigen::aligned_allocator<Vec4>> poles_;
};

}  // namespace trueblade
