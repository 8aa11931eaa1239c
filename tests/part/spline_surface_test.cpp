// B-spline evaluation against closed forms: a polynomial surface is reproduced, a rational quarter of a
// cylinder has the circle's radius and curvature, derivatives agree with finite differences.
#include "part/spline_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/random.h"

namespace trueblade {
namespace {

SplineSurface::Direction clamped(int degree, std::size_t poles, std::uint64_t stream) {
  Rng random(5, stream, "knots");
  SplineSurface::Direction direction{degree, std::vector<double>(static_cast<std::size_t>(degree) + 1, 0.0)};
  for (std::size_t i = static_cast<std::size_t>(degree) + 1; i < poles; ++i)
    direction.knots.push_back(direction.knots.back() + 0.2 + random.uniform());
  const double end = direction.knots.back() + 0.7;
  direction.knots.insert(direction.knots.end(), static_cast<std::size_t>(degree) + 1, end);
  return direction;
}

// The Greville abscissae as poles reproduce the parameter itself, so poles (gu, gv, gu + 2 gv) give that
// plane.
TEST(SplineSurface, GrevillePolesReproduceTheParameters) {
  for (const int p : {1, 2, 3, 5})
    for (const int q : {1, 3, 7}) {
      const auto u = clamped(p, 9, 1), v = clamped(q, 11, 2);
      const auto greville = [](const SplineSurface::Direction& d, std::size_t i) {
        double sum = 0;
        for (int k = 1; k <= d.degree; ++k) sum += d.knots[i + static_cast<std::size_t>(k)];
        return sum / d.degree;
      };
      std::vector<Vec3> poles;
      for (std::size_t i = 0; i < 9; ++i)
        for (std::size_t j = 0; j < 11; ++j) {
          const double gu = greville(u, i), gv = greville(v, j);
          poles.emplace_back(gu, gv, gu + 2 * gv);
        }
      const SplineSurface surface(u, v, poles, {});
      Rng random(1, 0, "uv");
      for (int k = 0; k < 50; ++k) {
        const Vec2 uv(u.last() * random.uniform(), v.last() * random.uniform());
        const SurfaceDerivatives s = surface.at(uv);
        // Rounding of sums of (p + 1)(q + 1) <= 48 terms below 25.
        EXPECT_LT((s.point - Vec3(uv.x(), uv.y(), uv.x() + 2 * uv.y())).norm(), 1e-13);
        EXPECT_LT((s.du - Vec3(1, 0, 1)).norm(), 1e-12);
        EXPECT_LT((s.dv - Vec3(0, 1, 2)).norm(), 1e-12);
        EXPECT_LT(s.duu.norm() + s.duv.norm() + s.dvv.norm(), 1e-11);
      }
    }
}

TEST(SplineSurface, RationalQuarterCylinderHasTheCirclesRadiusAndCurvature) {
  constexpr double kRadius = 7.0;
  const SplineSurface::Direction u{2, {0, 0, 0, 1, 1, 1}}, v{1, {0, 0, 1, 1}};
  const double w = std::sqrt(0.5);
  const std::vector<Vec3> poles{{kRadius, 0, 0},       {kRadius, 0, 5}, {kRadius, kRadius, 0},
                                {kRadius, kRadius, 5}, {0, kRadius, 0}, {0, kRadius, 5}};
  const std::vector<double> weights{1, 1, w, w, 1, 1};
  const SplineSurface surface(u, v, poles, weights);
  for (int k = 0; k <= 20; ++k) {
    const SurfaceDerivatives s = surface.at({k / 20.0, 0.3});
    EXPECT_NEAR(s.point.head<2>().norm(), kRadius, 1e-14 * kRadius);
    EXPECT_NEAR(s.point.z(), 1.5, 1e-15);
    // Curvature |r' x r''| / |r'|^3 = 1 / R.
    EXPECT_NEAR(s.du.cross(s.duu).norm() / std::pow(s.du.norm(), 3), 1 / kRadius, 1e-14);
    EXPECT_LT(s.dvv.norm() + s.duv.norm(), 1e-13);
  }
}

TEST(SplineSurface, DerivativesAgreeWithFiniteDifferences) {
  for (const bool rational : {false, true})
    for (const int degree : {2, 3, 4}) {
      const auto u = clamped(degree, 8, 3), v = clamped(3, 7, 4);
      std::vector<Vec3> poles;
      std::vector<double> weights;
      Rng random(7, 0, "poles");
      for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t j = 0; j < 7; ++j) {
          poles.push_back(Vec3(double(i), double(j), 0) + random.normal_vector());
          if (rational) weights.push_back(0.5 + random.uniform());
        }
      const SplineSurface surface(u, v, poles, weights);
      // Central differences: truncation h^2 |S'''| / 6 with |S'''| below 1e3 here is 2e-8 for h = 1e-5,
      // rounding 1e-15 * 10 / h = 1e-9; the derivatives themselves are of order 10.
      constexpr double kStep = 1e-5, kTolerance = 1e-6;
      for (int k = 0; k < 40; ++k) {
        const Vec2 uv(0.01 + 0.98 * u.last() * random.uniform(), 0.01 + 0.98 * v.last() * random.uniform());
        const SurfaceDerivatives s = surface.at(uv);
        const auto difference = [&](const Vec2& direction, auto member) -> Vec3 {
          return (surface.at(uv + kStep * direction).*member - surface.at(uv - kStep * direction).*member) /
                 (2 * kStep);
        };
        const Vec2 eu(1, 0), ev(0, 1);
        EXPECT_LT((difference(eu, &SurfaceDerivatives::point) - s.du).norm(), kTolerance);
        EXPECT_LT((difference(ev, &SurfaceDerivatives::point) - s.dv).norm(), kTolerance);
        EXPECT_LT((difference(ev, &SurfaceDerivatives::du) - s.duv).norm(), kTolerance);
        // The third derivative, of order 100, jumps at a knot of degree 3: h * 100.
        EXPECT_LT((difference(ev, &SurfaceDerivatives::dv) - s.dvv).norm(), 1e-3);
        if (degree > 2) {  // at degree 2 the second derivative itself jumps
          EXPECT_LT((difference(eu, &SurfaceDerivatives::du) - s.duu).norm(), 1e-3);
        }
      }
    }
}

}  // namespace
}  // namespace trueblade
